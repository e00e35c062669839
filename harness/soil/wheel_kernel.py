"""The force of soil on one wheel, compiled by numba.

Contact and stresses: Wong and Reece 1967 (pressure k z^n with its peak ahead of the bottom,
k = k_c / b + k_phi after Bekker), shear: Janosi and Hanamoto 1961 along each point's slid path in
two dimensions, side of the wheel: after Hegedus 1960, with friction on its face. Beyond these, soil that
is ploughed away instead of pressed bears less: the pressure falls with the ratio of the rim's velocity
into the soil to that along it (`flow_*`), and grousers that spin carry soil away. docs/soil.md tells
what the formulas are worth.

Each wheel touches the soil with two halves: ahead of its lowest point, and behind it, which is the same
seen backwards. A wheel that rolls leaves soil that does not rise again, so its rear half bears nothing
but for `rebound`; one that stands or is pressed down has both.

All that depends on ratios of velocities follows a direction of motion that turns within TURNING of path,
so that a wheel at rest keeps its forces. Equal input gives equal bits.
"""

import math
from typing import Any

import numba.extending
import numpy as np
from numba.core import cgutils
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel
from harness.soil.soils import SOIL_CONTACT

STATIONS = 10  # of the rim in each half, front to bottom
YIELD = 0.01  # [s] by whose slid path the shear is ahead: what damps a wheel that stands
TURNING = 0.005  # [m] of path within which a new direction of motion is taken over
COMPACTION = 0.1  # share of a rut's depth over which it bears again as before (Wong 1989)
SIDEWAYS = 1.25  # exponent of sideways motion in what flows: small slip angles hardly change the sinkage
HEAPED = 0.002  # [m] of the height of a cell, which are put beside a wheel at a time
NEAR = 0.02  # [m] around what touches the ground at most a step later, were it as fast as 8 m/s
DEEPEST = 1.5  # [wheel radii]: what is deeper bears no more

# State of a wheel: direction of motion (rim, ahead, left), that of travel (-1 back to 1 ahead),
# deepest sinkage at this place, what it has displaced that has no place yet; then the slid paths of
# the stations, along and across, of the front half and of the rear half.
PATHS = 6
STATE = PATHS + 4 * STATIONS
SOIL_NUMBERS, REBOUND = 27, 19

Doubles = NDArray[np.float64]


@inlined
def _half(  # noqa: PLR0915 - one loop over the rim, which calls would make slower
    soil: Doubles,
    size: tuple[float, float, float],
    depth: tuple[float, float],
    motion: tuple[float, float, float, float],
    velocity: tuple[float, float, float],
    slid: Doubles,
    dt: float,
) -> tuple[float, float, float, float]:
    """Forces ahead, left and up [N] and the braking moment [N m] of one half, seen in its direction.

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
    (k, n, slip_n, cohesion, friction, shear_length, peak, peak_driving, peak_braking) = (
        soil[0], soil[1], soil[2], soil[3], soil[4], soil[5], soil[6], soil[7], soil[8],
    )  # fmt: skip
    flowing, flow_lateral, flow_driving, flow_braking, flow_pressing = (
        soil[9], soil[10], soil[11], soil[12], soil[13],
    )  # fmt: skip
    r, b, grousers = size
    sinkage, rut = depth
    eu, ex, ey, travel = motion
    u, vx, vy = velocity
    deep = min(sinkage - rut, DEEPEST * r)
    if deep <= 0.0:
        slid[:] = 0.0
        return 0.0, 0.0, 0.0, 0.0
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
    stiffness = k * math.exp(-soil[14] * grousers * spinning**4)
    n += slip_n * (driving + braking)
    friction *= 1.0 + soil[15] * grousers
    shear_length *= 1.0 + soil[16] * grousers
    pressed = rut / (1.0 - COMPACTION)
    left_behind, pushed_aside = soil[17] * max(vx - u, 0.0), soil[18] * vy
    sweep = math.sqrt(u * u + left_behind * left_behind + pushed_aside * pushed_aside) + 1e-12
    carried = (
        2.0 * sweep * dt / (r * step)
    )  # of the first one, which is half a step from the rim's entry
    kept = 1.0 / (1.0 + carried)
    # A wheel that spins on the spot is as one that advances a little: it digs and does not press.
    dug = rest * driving
    beside = (flow_lateral * abs(ey) ** SIDEWAYS) ** 2 + rest - dug
    pushed = flow_driving * math.sqrt(speed * speed + dug) * driving
    standing = (rest - dug) / (1.0 + flow_pressing * flow_pressing)
    ahead, left, up, brake, jx, jy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
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
        c, s = c * turn_c + s * turn_s, s * turn_c - c * turn_s
    area = r * b * step
    return ahead * area, left * area, up * area, brake * area * r


@inlined
def wheel_force(
    soil: Doubles,
    size: tuple[float, float, float],
    front: tuple[float, float],
    rear: tuple[float, float],
    velocity: tuple[float, float, float, float],
    state: Doubles,
    dt: float,
) -> tuple[float, float, float, float]:
    """Returns the force of the soil on a wheel ahead, left and up [N], and its braking moment [N m].

    Args:
        soil: As `harness.soil.soils.Soil.numbers`.
        size: Radius and width [m], grousers (0 none, 1 as those of the trials).
        front: Depth of the lowest point and of the rut [m] against the ground ahead.
        rear: Those against the ground behind.
        velocity: Of the rim backwards, of the hub ahead, left and up [m/s].
        state: Of the wheel, shape (STATE,); is brought up to date.
        dt: Time since the last call [s]; for a steady state a huge one.
    """
    u, vx, vy, vz = velocity
    weight = (math.sqrt(u * u + vx * vx + vy * vy) + abs(vz)) * dt / TURNING
    for i in range(3):
        state[i] = (state[i] + velocity[i] * dt / TURNING) / (1.0 + weight)
    state[3] = (state[3] + vx * dt / TURNING) / (1.0 + (abs(vx) + abs(vz)) * dt / TURNING)
    eu, ex, ey, travel = state[0], state[1], state[2], state[3]
    h = max(front[0] - front[1], rear[0] - rear[1])
    if h <= 0.0:
        state[4] = 0.0
        state[PATHS:] = 0.0
        return 0.0, 0.0, 0.0, 0.0
    slid = state[PATHS:].reshape(2, 2, STATIONS)
    ahead, left, up, brake = 0.0, 0.0, 0.0, 0.0
    rebound = soil[REBOUND]
    for half in range(2):
        sign = 1.0 - 2.0 * half
        bears = 1.0 + (1.0 - rebound) * min(sign * travel, 0.0)
        depth = front if half == 0 else rear
        if bears > 0.0:
            x, y, z, m = _half(
                soil,
                size,
                depth,
                (sign * eu, sign * ex, ey, sign * travel),
                (sign * u, sign * vx, vy),
                slid[half],
                dt,
            )
            ahead += bears * sign * x
            left += bears * y
            up += bears * z
            brake += bears * sign * m
        else:
            slid[half] = 0.0
    h = min(h, DEEPEST * size[0])
    if ey * vy > 0.0:  # it only resists
        rest, along = max(1.0 - eu * eu - ex * ex - ey * ey, 0.0), eu - ex
        sideways = abs(ey) / math.sqrt(ey * ey + soil[23] * along * along + rest + 1e-18)
        length = size[0] * math.sin(min(math.acos(1.0 - h / size[0]), 0.5 * math.pi))
        # Of the soil beside it; and friction of that on the wheel's face.
        side = length * (soil[20] * h ** soil[21] + soil[25] * h) * sideways ** soil[22]
        left -= math.copysign(side, ey)
        if along * (u - vx) > 0.0:
            rubbed = soil[24] * side * along / math.sqrt(along * along + ey * ey + rest)
            ahead += rubbed
            brake += rubbed * size[0]
    # What was pressed does not rise again: a wheel that has risen by a part of its sinkage is off it.
    deepest = max(h, h + (state[4] - h) / (1.0 + (abs(u) + abs(vx) + abs(vy)) * dt / TURNING))
    state[4] = deepest
    springs = (COMPACTION + (1.0 - COMPACTION) * rebound) * deepest
    held = max(1.0 - (deepest - h) / max(springs, 1e-12), 0.0)
    damped = held * min(max(1.0 - soil[26] * vz, 0.0), 2.0)
    return ahead * damped, left * damped, up * damped, brake * damped


@inlined
def _level(field: Doubles, u: float, v: float) -> float:
    """Value of a grid between its vertices, in cells from its corner; clamped to the map."""
    rows, columns = field.shape
    u, v = min(max(u, 0.0), columns - 1.001), min(max(v, 0.0), rows - 1.001)
    col, row = int(u), int(v)
    du, dv = u - col, v - row
    low = field[row, col] * (1.0 - du) + field[row, col + 1] * du
    high = field[row + 1, col] * (1.0 - du) + field[row + 1, col + 1] * du
    return float(low * (1.0 - dv) + high * dv)


@inlined
def _press_down(
    grids: tuple[Doubles, Doubles, NDArray[np.float32]],
    frame: Doubles,
    hub: tuple[float, float],
    ahead: tuple[float, float],
    size: tuple[float, float],
    plane: tuple[float, float, float, float],
) -> float:
    """Leaves the wheel's print in the ground; returns the sum of the heights that it took [m].

    Args:
        grids: Heights without ruts and with them [m], and MuJoCo's, as `press`.
        frame: As `press`.
        hub: Of the wheel in the world [m].
        ahead: Direction of its heading, a unit vector.
        size: Radius and width of the wheel [m].
        plane: Height of the ground under the hub [m], its slopes ahead and to the left, the sinkage [m].
    """
    _, surface, field = grids
    x0, y0, cell, base, scale = frame[0], frame[1], frame[2], frame[3], 1.0 / frame[4]
    (r, b), (level, slope_x, slope_y, sinkage) = size, plane
    length = r * math.sin(math.acos(1.0 - min(sinkage, r) / r))
    reach_x = abs(ahead[0]) * length + 0.5 * abs(ahead[1]) * b
    reach_y = abs(ahead[1]) * length + 0.5 * abs(ahead[0]) * b
    rows, columns = surface.shape
    first_row, last_row = int((hub[1] - reach_y - y0) / cell), int((hub[1] + reach_y - y0) / cell) + 1
    first_col, last_col = int((hub[0] - reach_x - x0) / cell), int((hub[0] + reach_x - x0) / cell) + 1
    moved = 0.0
    for row in range(max(first_row, 0), min(last_row, rows - 1) + 1):
        for col in range(max(first_col, 0), min(last_col, columns - 1) + 1):
            dx, dy = x0 + col * cell - hub[0], y0 + row * cell - hub[1]
            x, y = dx * ahead[0] + dy * ahead[1], dy * ahead[0] - dx * ahead[1]
            if abs(x) > length or abs(y) > 0.5 * b:
                continue
            depth = (sinkage - r + math.sqrt(r * r - x * x)) * (1.0 - COMPACTION)
            bottom = level + slope_x * x + slope_y * y - depth
            if depth > 0.0 and bottom < surface[row, col]:
                moved += surface[row, col] - bottom
                surface[row, col] = bottom
                field[row, col] = (bottom - base) * scale
    return moved


@inlined
def _heap(
    grids: tuple[Doubles, Doubles, NDArray[np.float32]],
    frame: Doubles,
    hub: tuple[float, float],
    ahead: tuple[float, float],
    size: tuple[float, float],
    moved: float,
) -> bool:
    """Heaps heights of that sum [m] beside a wheel of that reach and width; returns if it could."""
    virgin, surface, field = grids
    x0, y0, cell, base, scale = frame[0], frame[1], frame[2], frame[3], 1.0 / frame[4]
    near, far = 0.5 * size[1] + cell, 0.5 * size[1] + 3.0 * cell
    reach_x = abs(ahead[0]) * size[0] + abs(ahead[1]) * far
    reach_y = abs(ahead[1]) * size[0] + abs(ahead[0]) * far
    rows, columns = surface.shape
    first_row, last_row = int((hub[1] - reach_y - y0) / cell), int((hub[1] + reach_y - y0) / cell) + 1
    first_col, last_col = int((hub[0] - reach_x - x0) / cell), int((hub[0] + reach_x - x0) / cell) + 1
    heaped, share = 0, 0.0
    for turn in range(2):  # counts, then heaps
        for row in range(max(first_row, 0), min(last_row, rows - 1) + 1):
            for col in range(max(first_col, 0), min(last_col, columns - 1) + 1):
                dx, dy = x0 + col * cell - hub[0], y0 + row * cell - hub[1]
                x, y = dx * ahead[0] + dy * ahead[1], dy * ahead[0] - dx * ahead[1]
                if abs(x) > size[0] or not near <= abs(y) <= far:
                    continue
                if turn == 0:
                    heaped += 1
                else:
                    virgin[row, col] += share
                    surface[row, col] += share
                    field[row, col] = (surface[row, col] - base) * scale
        share = moved / max(heaped, 1)
    return heaped > 0


@inlined
def press(  # noqa: PLR0913, PLR0915, PLR0917 - MuJoCo's arrays one by one, as numba takes them
    soils: Doubles,
    wheels: Doubles,
    bodies: NDArray[np.int64],
    grids: tuple[Doubles, Doubles, NDArray[np.float32]],
    frame: Doubles,
    states: Doubles,
    felt: Doubles,
    moving: tuple[Doubles, Doubles, Doubles, Doubles, Doubles],
    pushed: Doubles,
    dt: float,
    patches: NDArray[np.uint8],
    patch_cell: float,
) -> None:
    """Presses all wheels into the ground for one step.

    Args:
        soils: A row for each as `harness.soil.soils.Soil.numbers`.
        wheels: Radius, width [m], grousers, and whether the axis points left (1) or right (-1), of each.
        bodies: MuJoCo's body, joint and root body of each wheel.
        grids: Heights as they would be without ruts, as they are [m], and as MuJoCo has them.
        frame: Corner of the map x, y, distance of vertices, height of MuJoCo's 0 and of its 1 above it
            [m].
        states: Of the wheels, shape (n, STATE).
        felt: Sinkage [m], forces ahead, left, up [N], speed of the rim and of the hub ahead and left
            [m/s], depth of the rut ahead [m]; shape (n, 8).
        moving: MuJoCo's xpos, xaxis, cvel, subtree_com, xipos.
        pushed: MuJoCo's xfrc_applied.
        dt: Timestep [s].
        patches: Which soil there is at the vertices of a grid of the same corner.
        patch_cell: Distance of two of those [m].
    """
    xpos, xaxis, cvel, subtree_com, xipos = moving
    virgin, surface, _ = grids
    x0, y0, cell = frame[0], frame[1], frame[2]
    for i in range(bodies.shape[0]):
        body, joint, root = bodies[i, 0], bodies[i, 1], bodies[i, 2]
        r, b, to_left = wheels[i, 0], wheels[i, 1], wheels[i, 3]
        hx, hy, hz = xpos[body, 0], xpos[body, 1], xpos[body, 2]
        ax, ay, az = to_left * xaxis[joint, 0], to_left * xaxis[joint, 1], to_left * xaxis[joint, 2]
        flat = math.sqrt(ax * ax + ay * ay)
        ex, ey = (ay / flat, -ax / flat) if flat > 1e-6 else (1.0, 0.0)  # the heading on the map
        u, v = (hx - x0) / cell, (hy - y0) / cell
        lx, ly = 0.8 * r / cell, 0.4 * b / cell
        middle = _level(virgin, u, v)
        front, back = _level(virgin, u + lx * ex, v + lx * ey), _level(virgin, u - lx * ex, v - lx * ey)
        left, right = _level(virgin, u - ly * ey, v + ly * ex), _level(virgin, u + ly * ey, v - ly * ex)
        slope_x, slope_y = (front - back) / (1.6 * r), (left - right) / (0.8 * b)
        level = (2.0 * middle + front + back + left + right) / 6.0
        up = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
        nx, ny = (slope_y * ey - slope_x * ex) * up, (-slope_x * ey - slope_y * ex) * up
        tilt = nx * ax + ny * ay + up * az
        reach = r * math.sqrt(max(1.0 - tilt * tilt, 0.0)) + 0.5 * b * abs(tilt)
        sinkage = reach - (hz - level) * up
        # Ahead is across the axle and along the ground, left is across both.
        fx, fy, fz = ay * up - az * ny, az * nx - ax * up, ax * ny - ay * nx
        norm = math.sqrt(fx * fx + fy * fy + fz * fz)
        if norm > 1e-6:
            fx, fy, fz = fx / norm, fy / norm, fz / norm
        sx, sy, sz = ny * fz - up * fy, up * fx - nx * fz, nx * fy - ny * fx
        wx, wy, wz = cvel[body, 0], cvel[body, 1], cvel[body, 2]
        dx, dy, dz = hx - subtree_com[root, 0], hy - subtree_com[root, 1], hz - subtree_com[root, 2]
        vx = cvel[body, 3] + wy * dz - wz * dy
        vy = cvel[body, 4] + wz * dx - wx * dz
        vz = cvel[body, 5] + wx * dy - wy * dx
        rim = (wx * ax + wy * ay + wz * az) * r
        velocity = (
            rim,
            vx * fx + vy * fy + vz * fz,
            vx * sx + vy * sy + vz * sz,
            vx * nx + vy * ny + vz * up,
        )
        length = r * math.sin(math.acos(1.0 - min(max(sinkage, 0.0), r) / r)) / cell + 1.2
        at_front, at_back = (u + length * ex, v + length * ey), (u - length * ex, v - length * ey)
        ahead_rut = max(_level(virgin, *at_front) - _level(surface, *at_front), 0.0)
        back_rut = max(_level(virgin, *at_back) - _level(surface, *at_back), 0.0)
        patch_row = min(max(int((hy - y0) / patch_cell + 0.5), 0), patches.shape[0] - 1)
        patch_col = min(max(int((hx - x0) / patch_cell + 0.5), 0), patches.shape[1] - 1)
        soil = soils[patches[patch_row, patch_col]]
        ahead, side, lift, brake = wheel_force(
            soil,
            (r, b, wheels[i, 2]),
            (sinkage, ahead_rut),
            (sinkage, back_rut),
            velocity,
            states[i],
            dt,
        )
        px, py, pz = ahead * fx + side * sx + lift * nx, ahead * fy + side * sy + lift * ny, 0.0
        pz = ahead * fz + side * sz + lift * up
        arm = side * (r - 0.5 * max(sinkage, 0.0))  # the side force acts at the ground
        cx, cy, cz = hx - xipos[body, 0], hy - xipos[body, 1], hz - xipos[body, 2]
        pushed[body, 0], pushed[body, 1], pushed[body, 2] = px, py, pz
        pushed[body, 3] = cy * pz - cz * py - brake * ax + arm * fx
        pushed[body, 4] = cz * px - cx * pz - brake * ay + arm * fy
        pushed[body, 5] = cx * py - cy * px - brake * az + arm * fz
        felt[i, 0], felt[i, 1], felt[i, 2], felt[i, 3] = sinkage, ahead, side, lift
        felt[i, 4], felt[i, 5], felt[i, 6] = velocity[0], velocity[1], velocity[2]
        felt[i, 7] = ahead_rut
        if lift > 0.0 and soil[REBOUND] < 1.0:
            plane = (level, slope_x, slope_y, sinkage)
            states[i, 5] += _press_down(grids, frame, (hx, hy), (ex, ey), (r, b), plane)
            reach = r * math.sin(math.acos(1.0 - min(sinkage, r) / r))
            if states[i, 5] > HEAPED and _heap(
                grids, frame, (hx, hy), (ex, ey), (reach, b), states[i, 5]
            ):
                states[i, 5] = 0.0


@inlined
def _let_near_touch(
    geoms: NDArray[np.int64],
    boxes: Doubles,
    placed: tuple[Doubles, Doubles],
    affinity: NDArray[np.int32],
    solid: Doubles,
    frame: Doubles,
) -> None:
    """Lets MuJoCo look for contacts of the ground only with what will be near it in the next step.

    Its look at the cells under an underside costs more than the rest of the step, and finds nothing.

    Args:
        geoms: What is no wheel and touches soil.
        boxes: Middle and half sizes of each in its own frame [m], shape (n, 6).
        placed: MuJoCo's geom_xpos and geom_xmat.
        affinity: MuJoCo's geom_conaffinity.
        solid: Heights that they meet [m].
        frame: Corner x, y and distance of the solid heights [m].
    """
    x0, y0, cell = frame[0], frame[1], frame[2]
    rows, columns = solid.shape
    for i in range(geoms.size):
        geom = geoms[i]
        at, turn = placed[0][geom], placed[1][geom]
        low, reach = np.empty(3), np.empty(3)
        for k in range(3):
            middle, reach[k] = at[k], NEAR
            for j in range(3):
                middle += turn[3 * k + j] * boxes[i, j]
                reach[k] += abs(turn[3 * k + j]) * boxes[i, 3 + j]
            low[k] = middle - reach[k]
        first_col, first_row = int((low[0] - x0) / cell), int((low[1] - y0) / cell)
        last_col = int((low[0] + 2.0 * reach[0] - x0) / cell) + 1
        last_row = int((low[1] + 2.0 * reach[1] - y0) / cell) + 1
        near = False
        for row in range(max(first_row, 0), min(last_row, rows - 1) + 1):
            for col in range(max(first_col, 0), min(last_col, columns - 1) + 1):
                near |= solid[row, col] > low[2]
            if near:
                break
        affinity[geom] = affinity[geom] | SOIL_CONTACT if near else affinity[geom] & ~SOIL_CONTACT


@numba.extending.intrinsic  # type: ignore[untyped-decorator]  # numba has no types
def pointer(_: object, address: object) -> tuple[object, object]:  # noqa: ARG001 - its type is what counts
    """Makes an address, an integer, a pointer that numba.carray takes."""

    def generate(_: object, builder: Any, __: object, args: Any) -> object:  # noqa: ANN401 - numba's
        return builder.inttoptr(args[0], cgutils.voidptr_t)

    return numba.types.voidptr(numba.types.int64), generate


@kernel("void(int64)")
def press_bed(address: int) -> None:
    """Presses the wheels of a bed, whose arrays are told by their addresses, as `bed.addresses`."""
    told = numba.carray(pointer(address), (33,), np.int64)
    wheels, rows, columns, bodies, joints = told[0], told[2], told[3], told[4], told[5]
    solids, geoms, solid_rows, solid_columns = told[6], told[7], told[8], told[9]
    frame = numba.carray(pointer(told[14]), (6,), np.float64)
    _let_near_touch(
        numba.carray(pointer(told[24]), (solids,), np.int64),
        numba.carray(pointer(told[25]), (solids, 6), np.float64),
        (
            numba.carray(pointer(told[26]), (geoms, 3), np.float64),
            numba.carray(pointer(told[27]), (geoms, 9), np.float64),
        ),
        numba.carray(pointer(told[28]), (geoms,), np.int32),
        numba.carray(pointer(told[29]), (solid_rows, solid_columns), np.float64),
        numba.carray(pointer(told[30]), (3,), np.float64),
    )
    press(
        numba.carray(pointer(told[10]), (told[32], SOIL_NUMBERS), np.float64),
        numba.carray(pointer(told[11]), (wheels, 4), np.float64),
        numba.carray(pointer(told[12]), (wheels, 3), np.int64),
        (
            numba.carray(pointer(told[13]), (rows, columns), np.float64),
            numba.carray(pointer(told[15]), (rows, columns), np.float64),
            numba.carray(pointer(told[16]), (rows, columns), np.float32),
        ),
        frame,
        numba.carray(pointer(told[17]), (wheels, STATE), np.float64),
        numba.carray(pointer(told[18]), (wheels, 8), np.float64),
        (
            numba.carray(pointer(told[19]), (bodies, 3), np.float64),
            numba.carray(pointer(told[20]), (joints, 3), np.float64),
            numba.carray(pointer(told[21]), (bodies, 6), np.float64),
            numba.carray(pointer(told[22]), (bodies, 3), np.float64),
            numba.carray(pointer(told[23]), (bodies, 3), np.float64),
        ),
        numba.carray(pointer(told[1]), (bodies, 6), np.float64),
        frame[5],
        numba.carray(pointer(told[31]), (solid_rows, solid_columns), np.uint8),
        numba.carray(pointer(told[30]), (3,), np.float64)[2],
    )


@kernel("void(float64[::1], float64[:,::1], float64, float64[:,::1])")
def steady_wheels(soil: Doubles, trials: Doubles, width: float, results: Doubles) -> None:
    """Sets what wheels do that are drawn through flat soil at a constant speed under a load.

    Args:
        soil: As `harness.soil.soils.Soil.numbers`.
        trials: Radius [m], grousers, speeds of the rim, of the hub ahead and left [m/s], load [N],
            shape (n, 6).
        width: Of the wheels [m].
        results: Sinkage [m], forces ahead and left [N], braking moment [N m], shape (n, 4); the least
            sinkage that carries the load, NaN where none does.
    """
    state = np.zeros(STATE)
    for i in range(trials.shape[0]):
        r, load = trials[i, 0], trials[i, 5]
        size = (r, width, trials[i, 1])
        velocity = (trials[i, 2], trials[i, 3], trials[i, 4], 0.0)
        low, high, h = 0.0, 0.0, 0.0
        while high == 0.0 and h < DEEPEST * r:
            h += 0.02 * r
            if wheel_force(soil, size, (h, 0.0), (h, 0.0), velocity, state, 1e9)[2] >= load:
                high = h
            else:
                low = h
        for _ in range(30):
            h = 0.5 * (low + high)
            if wheel_force(soil, size, (h, 0.0), (h, 0.0), velocity, state, 1e9)[2] >= load:
                high = h
            else:
                low = h
        ahead, left, _, brake = wheel_force(soil, size, (high, 0.0), (high, 0.0), velocity, state, 1e9)
        results[i] = (high, ahead, left, brake) if high else (math.nan, math.nan, math.nan, math.nan)


@kernel("void(float64[::1], float64, float64, float64, float64[::1], float64[::1])")
def press_wheel(
    soil: Doubles, radius: float, width: float, speed: float, depths: Doubles, forces: Doubles
) -> None:
    """Sets the force up [N] on a smooth wheel that sinks straight down and does not turn.

    Args:
        soil: As `harness.soil.soils.Soil.numbers`.
        radius: Of the wheel [m].
        width: Of the wheel [m].
        speed: At which it sinks [m/s].
        depths: At which the force is wanted, ascending [m].
        forces: Of the same shape.
    """
    state, h, dt = np.zeros(STATE), 0.0, 0.01
    size, velocity = (radius, width, 0.0), (0.0, 0.0, 0.0, -speed)
    for i in range(depths.size):
        forces[i] = 0.0
        while h < depths[i]:
            h += speed * dt
            forces[i] = wheel_force(soil, size, (h, 0.0), (h, 0.0), velocity, state, dt)[2]
