"""The stresses of soil on one half of a wheel's rim, compiled by numba.

Contact and stresses: Wong and Reece 1967 (pressure k z^n with its peak ahead of the bottom,
k = k_c / b + k_phi after Bekker), shear: Janosi and Hanamoto 1961 along each point's slid path in
two dimensions. Beyond these, soil that is ploughed away instead of pressed bears less: the pressure
falls with the ratio of the rim's velocity into the soil to that along it (`flow_*`), and grousers that
spin carry soil away. docs/soil.md says what the formulas are worth. Equal input gives equal bits.
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined
from harness.soil.soils import NUMBERS

STATIONS = 10  # of the rim in each half, front to bottom
YIELD = 0.01  # [s] by whose slid path the shear is ahead: what damps a wheel that stands
COMPACTION = 0.1  # share of a rut's depth over which it bears again as before (Wong 1989)
SIDEWAYS = 1.25  # exponent of sideways motion in what flows: small slip angles hardly change the sinkage
DEEPEST = 1.5  # [wheel radii]: what is deeper bears no more

Doubles = NDArray[np.float64]

# Places of a soil's numbers behind those of the pressure.
DIG_GROUSERS, GROUSER_FRICTION, GROUSER_SHEAR, STAY_BRAKING, STAY_LATERAL = map(
    NUMBERS.index, ("dig_grousers", "grouser_friction", "grouser_shear", "stay_braking", "stay_lateral")
)


@inlined
def half_force(  # noqa: PLR0915 - one loop over the rim, which calls would make slower
    soil: Doubles,
    size: tuple[float, float, float],
    depth: tuple[float, float],
    motion: tuple[float, float, float, float],
    velocity: tuple[float, float, float],
    slid: Doubles,
    dt: float,
) -> tuple[float, float, float, float, float]:
    """Forces ahead, left and up [N], braking moment [N m] of one half, seen in its direction; and grip.

    The grip is how fast the shear force grows with the slid path, at most [N/m].

    Args:
        soil: As `harness.soil.soils.Soil.numbers`.
        size: Radius and width of the wheel [m], grousers (0 none, 1 as those of the trials).
        depth: Of the wheel's lowest point below the ground ahead as it would be without ruts, and of the
            rut ahead [m].
        motion: Direction of motion: of the rim, ahead, left, shorter than 1 where it has none; travel.
        velocity: Of the rim backwards, of the hub ahead and left [m/s].
        slid: Paths along and across of the stations [m], shape (2, STATIONS); are brought up to date.
        dt: Time since the last call [s]; a steady state has a huge one.
    """
    k, n, slip_n, cohesion, friction, shear_length = soil[0], soil[1], soil[2], soil[3], soil[4], soil[5]
    peak, peak_driving, peak_braking, flowing = soil[6], soil[7], soil[8], soil[9]
    flow_lateral, flow_driving, flow_braking, flow_pressing = soil[10], soil[11], soil[12], soil[13]
    r, b, grousers = size
    sinkage, rut = depth
    eu, ex, ey, travel = motion
    u, vx, vy = velocity
    deep = min(sinkage - rut, DEEPEST * r)
    if deep <= 0.0:
        slid[:] = 0.0
        return 0.0, 0.0, 0.0, 0.0, 0.0
    speed = math.sqrt(ex * ex + ey * ey)
    rest = max(1.0 - eu * eu - ex * ex - ey * ey, 0.0)  # of a wheel that stands, sinks or trembles
    top = max(abs(eu), speed, rest, 1e-9)
    slip = (abs(eu) - abs(ex)) / top if eu * ex >= 0.0 else 1.0
    driving, braking = max(slip, 0.0), max(-slip, 0.0)
    spinning = max((abs(eu) - speed) / top, 0.0)  # slip against the whole way over the ground
    first = math.acos(1.0 - deep / r)
    lead = min(max(peak + peak_driving * driving + peak_braking * braking, 0.0), 0.95) * max(travel, 0.0)
    top_stress = lead * first
    step = first / STATIONS
    cos_first = math.cos(first)
    stiffness = k * math.exp(-soil[DIG_GROUSERS] * grousers * spinning**4)
    n += slip_n * (driving + braking)
    friction *= 1.0 + soil[GROUSER_FRICTION] * grousers
    shear_length *= 1.0 + soil[GROUSER_SHEAR] * grousers
    pressed = rut / (1.0 - COMPACTION)
    left_behind, pushed_aside = soil[STAY_BRAKING] * max(vx - u, 0.0), soil[STAY_LATERAL] * vy
    sweep = math.sqrt(u * u + left_behind * left_behind + pushed_aside * pushed_aside) + 1e-12
    carried = 2.0 * sweep * dt / (r * step)  # of the first, which is half a step from the rim's entry
    kept = 1.0 / (1.0 + carried)
    # A wheel that spins on the spot is as one that advances a little: it digs and does not press.
    dug = rest * driving
    beside = (flow_lateral * abs(ey) ** SIDEWAYS) ** 2 + rest - dug
    pushed = flow_driving * math.sqrt(speed * speed + dug) * driving
    standing = (rest - dug) / (1.0 + flow_pressing * flow_pressing)
    ahead, left, up, brake, grip, jx, jy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    # Cosines and sines of a station's angle and of that whose pressure it has: turned on step by step.
    c, s = math.cos(first - 0.5 * step), math.sin(first - 0.5 * step)
    turn_c, turn_s = math.cos(step), math.sin(step)
    back = step * (first - top_stress) / max(top_stress, 1e-12)
    back_c, back_s, at_c, at_s, is_behind = math.cos(back), math.sin(back), c, s, False
    for i in range(STATIONS):
        angle = first - (i + 0.5) * step
        if angle >= top_stress:
            at_c, at_s = c, s
        elif is_behind:
            at_c, at_s = at_c * back_c - at_s * back_s, at_s * back_c + at_c * back_s
        else:
            at, is_behind = first - angle / top_stress * (first - top_stress), True
            at_c, at_s = math.cos(at), math.sin(at)
        sliding_x = u - vx * c
        jx = (slid[0, i] + dt * sliding_x + carried * jx) * kept
        jy = (slid[1, i] - dt * vy + carried * jy) * kept
        slid[0, i], slid[1, i] = jx, jy
        if i == 0:
            carried *= 0.5
            kept = 1.0 / (1.0 + carried)
        z = r * (at_c - cos_first) + rut
        if z < pressed:  # what is compacted already bears again within a part of its depth
            z = pressed * (z - rut) / max(pressed - rut, 1e-12)
        stress = stiffness * max(z, 0.0) ** n
        if flowing < 1.0:
            into = max(ex * at_s, 0.0)
            along = eu - ex * c
            away = pushed if along > 0.0 else flow_braking * along
            into = into * into + dug * at_s * at_s
            bearing = math.sqrt((into + standing) / (into + away * away + beside + 1e-18))
            stress *= flowing + (1.0 - flowing) * bearing
        px, py = jx + YIELD * sliding_x, jy - YIELD * vy
        path = math.sqrt(px * px + py * py) + 1e-12
        strength = (cohesion + stress * friction) * (1.0 - math.exp(-path / shear_length)) / path
        tx = strength * px
        ahead += tx * c - stress * s
        up += tx * s + stress * c
        left += strength * py
        brake += tx
        grip += strength
        c, s = c * turn_c + s * turn_s, s * turn_c - c * turn_s
    area = r * b * step
    return ahead * area, left * area, up * area, brake * area * r, grip * area
