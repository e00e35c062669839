"""What is known of all drivers: which of them look at scans."""

from contextlib import nullcontext
from typing import ClassVar

import numpy as np
import pytest

from harness.base.sim_time import CONTROL_PERIOD_NS, TICK_NS
from harness.drivers import DRIVERS
from harness.drivers.base import DriverContext, Observation, TakesGoals
from harness.episode.episode import Episode
from harness.robots import find_rover
from harness.samples import Imu, JointStates, LaserScan, Odometry, Pose, Twist
from harness.spec.run import Run
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


class Witness:
    """Drives on, and notes what it is shown."""

    summary, senses = "", frozenset({LaserScan, Imu, Pose, Odometry, JointStates})
    shown: ClassVar[list[tuple[int, bool, list[int]]]] = []

    def __init__(self, _: DriverContext) -> None:
        pass

    def command(self, seen: Observation) -> Twist:
        stamps = [reading.stamp_ns for reading in seen.readings.values()]
        self.shown.append((seen.time_ns, seen.ranges is None, stamps))
        return Twist(0.5, 0.2)


def test_a_driver_is_shown_the_newest_readings_and_none_from_before_a_reset(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Witness, "shown", [])
    monkeypatch.setitem(DRIVERS.loaded(), "witness", Witness)
    run = Run.of(driver="witness", terrain="rocky", duration=1.5, lidar_beams=8, resets=(0.52, 1.0))
    assert len(list(Episode(run).batches())) == len(Witness.shown) == 30
    for period, (since_ns, is_blind, stamps) in enumerate(Witness.shown):
        began = max(begin for begin in (0, 11, 20) if begin <= period)
        assert since_ns == (period - began) * CONTROL_PERIOD_NS
        assert is_blind == (period == began)
        assert len(stamps) == (0 if period == began else len(Witness.senses))
        assert all(0 <= period * CONTROL_PERIOD_NS - stamp <= TICK_NS for stamp in stamps)
