"""The force of soil on one wheel, compiled by numba: of both halves of its rim, and beside it.

A wheel touches the soil with two halves: ahead of its lowest point, and behind it, which is the same
seen backwards. A wheel that rolls leaves soil that does not rise again, so its rear half bears nothing
but for `rebound`; one that stands or is pressed down has both. Beside it: Hegedus 1960, with friction on
its face.

All that depends on ratios of velocities follows a direction of motion that turns within TURNING of path,
so that a wheel at rest keeps its forces.
"""

import math
from dataclasses import dataclass

from harness.base.compiled import inlined
from harness.soil.rim import COMPACTION, DEEPEST, STATIONS, YIELD, Doubles, half_force
from harness.soil.soils import NUMBERS

TURNING = 0.005  # [m] of path within which a new direction of motion is taken over

# State of a wheel: direction of motion (rim, ahead, left), that of travel (-1 back to 1 ahead),
# deepest sinkage at this place, what it has displaced that has no place yet; then the slid paths of
# the stations, along and across, of the front half and of the rear half.
UNPLACED, PATHS = 5, 6
STATE = PATHS + 4 * STATIONS
REBOUND, DAMPING = NUMBERS.index("rebound"), NUMBERS.index("damping")
MODULUS, EXPONENT, FLOW, SLIP, FRICTION, COHESION = (  # of the side
    NUMBERS.index(f"side_{name}")
    for name in ("modulus", "exponent", "flow", "slip", "friction", "cohesion")
)


@dataclass(frozen=True)
class SoilWheel:
    """A wheel in the model."""

    body: int  # of the wheel
    joint: int  # about which it turns
    root: int  # body of the rover
    radius: float  # [m]
    width: float  # [m]
    grousers: float  # 0 for a smooth rim, 1 for 24 of 5 mm on a wheel of 125 mm
    to_left: bool  # whether the joint's axis points to the rover's left, else to the right
    load: float  # share of the rover's weight [N]


@inlined
def wheel_force(
    soil: Doubles,
    size: tuple[float, float, float],
    front: tuple[float, float],
    rear: tuple[float, float],
    velocity: tuple[float, float, float, float],
    state: Doubles,
    dt: float,
) -> tuple[float, float, float, float, float]:
    """Returns forces of the soil on a wheel ahead, left and up [N], braking moment [N m] and inertia.

    The inertia [kg m^2] is what the rim is to have beside its own for a step: with it the step is
    implicit in the moment (linearly, after Rosenbrock), so that shear that grows steeply with slip
    does not turn the slip round in each step; what is steady stays as it is.

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
        return 0.0, 0.0, 0.0, 0.0, 0.0
    slid = state[PATHS:].reshape(2, 2, STATIONS)
    ahead, left, up, brake, grip = 0.0, 0.0, 0.0, 0.0, 0.0
    rebound = soil[REBOUND]
    for half in range(2):
        sign = 1.0 - 2.0 * half
        bears = 1.0 + (1.0 - rebound) * min(sign * travel, 0.0)
        depth = front if half == 0 else rear
        if bears > 0.0:
            x, y, z, m, g = half_force(
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
            grip += bears * g
        else:
            slid[half] = 0.0
    h = min(h, DEEPEST * size[0])
    if ey * vy > 0.0:  # it only resists
        rest, along = max(1.0 - eu * eu - ex * ex - ey * ey, 0.0), eu - ex
        sideways = abs(ey) / math.sqrt(ey * ey + soil[SLIP] * along * along + rest + 1e-18)
        length = size[0] * math.sin(min(math.acos(1.0 - h / size[0]), 0.5 * math.pi))
        # Of the soil beside it; and friction of that on the wheel's face.
        side = (
            length * (soil[MODULUS] * h ** soil[EXPONENT] + soil[COHESION] * h) * sideways ** soil[FLOW]
        )
        left -= math.copysign(side, ey)
        if along * (u - vx) > 0.0:
            rubbed = soil[FRICTION] * side * along / math.sqrt(along * along + ey * ey + rest)
            ahead += rubbed
            brake += rubbed * size[0]
    # What was pressed does not rise again: a wheel that has risen by a part of its sinkage is off it.
    deepest = max(h, h + (state[4] - h) / (1.0 + (abs(u) + abs(vx) + abs(vy)) * dt / TURNING))
    state[4] = deepest
    springs = (COMPACTION + (1.0 - COMPACTION) * rebound) * deepest
    held = max(1.0 - (deepest - h) / max(springs, 1e-12), 0.0)
    damped = held * min(max(1.0 - soil[DAMPING] * vz, 0.0), 2.0)
    inertia = dt * (YIELD + dt) * size[0] * size[0] * grip
    return ahead * damped, left * damped, up * damped, brake * damped, inertia * damped
