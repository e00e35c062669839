"""Whether steps of physics can follow a wheel on a soil, and what would do if they cannot.

The force of soil is explicit in the motion of a wheel's hub: too stiff a soil makes it swing up and
down, shear that is too steep throws it to and fro. In the turning of its rim the step is implicit.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from harness.base.errors import UsageError
from harness.base.sim_time import timesteps
from harness.soil.rig_kernel import HUGE_STEP, steady_wheels
from harness.soil.rim import COMPACTION, YIELD, Doubles
from harness.soil.soils import Soil
from harness.soil.wheel_force import SoilWheel

STABLE = 0.5  # [rad] that the stiffest wheel may swing in a step
GRIPPED = 0.8  # share of a hub's slip that shear may take away in a step; it trembles from 1 on


def check_steps(
    soil: Soil, numbers: Doubles, wheels: Sequence[SoilWheel], gravity: float, timestep: float
) -> None:
    """Checks that wheels stay calm on a soil; else UsageError names the timestep that they need.

    Args:
        soil: On which they are.
        numbers: Of it, for the kernels.
        wheels: With the load that each bears.
        gravity: [m/s^2].
        timestep: [s].
    """
    for wheel in wheels:
        swing, grip = _stiffness(soil, numbers, wheel, gravity)

        def swings(dt: float, swing: float = swing) -> float:
            return swing * dt / STABLE

        def thrown(dt: float, grip: float = grip) -> float:
            return grip * (YIELD + dt) * dt / GRIPPED

        _demand(timestep, swings, "it swings up and down", "smaller k_phi")
        _demand(timestep, thrown, "shear throws it to and fro", "larger shear_length")


def _stiffness(soil: Soil, numbers: Doubles, wheel: SoilWheel, gravity: float) -> tuple[float, float]:
    """Angular frequency of a rolling wheel up and down [rad/s], and how its shear grows [1/s^2].

    The shear is that force over slid path and over the mass that the wheel bears.
    """
    loads = np.array([0.5, 1.0, 1.5]) * wheel.load
    trials = np.zeros((3, 6))
    trials[:] = wheel.radius, wheel.grousers, 0.01, 0.01, 0.0, 0.0
    trials[:, 5] = loads
    results = np.empty((3, 5))
    steady_wheels(numbers, trials, wheel.width, results)
    sinkages = results[:, 0]
    if np.isnan(sinkages).any():
        raise UsageError(
            f"a wheel sinks in whole under {loads[-1]:.0f} N; give a soil of a larger k_phi"
        )
    stiffness = (loads[2] - loads[0]) / max(sinkages[2] - sinkages[0], 1e-9)
    stiffness /= 1.0 - (1.0 - COMPACTION) * (soil.rebound == 0.0) * 0.8
    mass = wheel.load / gravity
    growth = results[1, 4] / ((HUGE_STEP * wheel.radius) ** 2 * mass)
    return math.sqrt(stiffness / mass), growth


def _demand(timestep: float, share: Callable[[float], float], part: str, soil: str) -> None:
    """Raises UsageError if a step takes more than its share, with the largest step that does not."""
    if share(timestep) > 1.0:
        valid = [f"--timestep {each:g}, or " for each in timesteps() if share(each) <= 1.0]
        raise UsageError(
            f"the soil is too stiff for a wheel at steps of {1e3 * timestep:g} ms: {part} "
            f"({share(timestep):.1f} times too much); give {''.join(valid[:1])}a soil of a {soil}"
        )
