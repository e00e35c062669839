"""What a wheel does on a rig: drawn through flat soil at a constant speed, or pressed down."""

import math

import numpy as np

from harness.base.compiled import kernel
from harness.soil.rim import DEEPEST, Doubles
from harness.soil.wheel_force import STATE, wheel_force

HUGE_STEP = 1e9  # [s] after which whatever was before is forgotten


@kernel("void(float64[::1], float64[:,::1], float64, float64[:,::1])")
def steady_wheels(soil: Doubles, trials: Doubles, width: float, results: Doubles) -> None:
    """Sets what wheels do that are drawn through flat soil at a constant speed under a load.

    Args:
        soil: As `harness.soil.soils.Soil.numbers`.
        trials: Radius [m], grousers, speeds of the rim, of the hub ahead and left [m/s], load [N],
            shape (n, 6).
        width: Of the wheels [m].
        results: Sinkage [m], forces ahead and left [N], braking moment [N m], and the inertia that shear
            gives the rim within HUGE_STEP [kg m^2], shape (n, 5); of the least sinkage that carries
            the load, NaN where none does.
    """
    state = np.zeros(STATE)
    for i in range(trials.shape[0]):
        r, load = trials[i, 0], trials[i, 5]
        size = (r, width, trials[i, 1])
        velocity = (trials[i, 2], trials[i, 3], trials[i, 4], 0.0)
        low, high, h = 0.0, 0.0, 0.0
        while high == 0.0 and h < DEEPEST * r:
            h += 0.02 * r
            if wheel_force(soil, size, (h, 0.0), (h, 0.0), velocity, state, HUGE_STEP)[2] >= load:
                high = h
            else:
                low = h
        for _ in range(30):
            h = 0.5 * (low + high)
            if wheel_force(soil, size, (h, 0.0), (h, 0.0), velocity, state, HUGE_STEP)[2] >= load:
                high = h
            else:
                low = h
        if high == 0.0:
            results[i] = math.nan
            continue
        ahead, left, _, brake, inertia = wheel_force(
            soil, size, (high, 0.0), (high, 0.0), velocity, state, HUGE_STEP
        )
        results[i] = (high, ahead, left, brake, inertia)


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
