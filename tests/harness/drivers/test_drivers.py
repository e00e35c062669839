"""What is known of all drivers: which of them look at scans."""

from contextlib import nullcontext

import numpy as np
import pytest

from harness.drivers import DRIVERS, DriverContext, Observation, TakesGoals
from harness.robots import find_rover
from harness.samples import LaserScan
from harness.world.obstacles import Obstacle, ObstacleKind

POST = Obstacle(
    kind=ObstacleKind.HAZARD, shape="cylinder", half_size=(0.1, 1.0), position=(5.0, 0.0, 0.5)
)


class Seen(Exception):
    """A scan was looked at."""


class Watched(Observation):
    @property
    def ranges(self) -> np.ndarray:
        raise Seen

    def __init__(self, time_ns: int) -> None:
        for name, value in (("time_ns", time_ns), ("x", 0.0), ("y", 0.0), ("yaw", 0.0)):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "touches_hazard", False)


@pytest.mark.parametrize("name", DRIVERS)
def test_drivers_that_look_at_scans_are_those_of_which_it_is_said(name: str) -> None:
    bearings, rng = np.linspace(-np.pi, np.pi, 8), np.random.default_rng(0)
    context = DriverContext(find_rover("leo"), (20.0, 20.0), bearings, rng, (POST,))
    driver = DRIVERS[name](context)
    if isinstance(driver, TakesGoals):
        driver.head_for(8.0, 3.0, 0.0)  # before, it stands
    with pytest.raises(Seen) if LaserScan in DRIVERS[name].senses else nullcontext():
        for period in range(200):
            driver.command(Watched(50_000_000 * period))
