"""Which sensors are made of what there is, and what each is asked when."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from harness.robots import find_rover
from harness.samples import GroundTruth, Imu, Odometry, Pose, Sample, TruthState
from harness.sensors.base import Sensor
from harness.sensors.suite import SensorSuite
from harness.sensors.table import SensorRow, Topic
from tests.harness.conftest import MakeSimulation

ZERO = find_rover("rover_zero4wd")
KINDS: dict[str, Callable[[int], Sample]] = {
    "pose": lambda stamp: Pose(stamp, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)),
    "truth": lambda stamp: TruthState(stamp, False, False, False, 0.0, 0.0, 0.0, (), 0.0),
}


class Spy(Sensor):
    """Notes what it is asked, and when; that is its stamp, too."""

    def __init__(self, name: str, log: list[str], period_ticks: int) -> None:
        self._name, self._log, self.period_ticks = name, log, period_ticks

    def observe(self) -> None:
        self._log.append(f"{self._name} observe")

    def read(self) -> Sample:
        self._log.append(f"{self._name} read")
        return KINDS[self._name](len(self._log))

    def before_reset(self) -> None:
        self._log.append(f"{self._name} before")

    def after_reset(self) -> None:
        self._log.append(f"{self._name} after")


def row(name: str, sample: type[Sample], rate: int) -> SensorRow:
    reader, topic = f"{__name__}:Spy", Topic(name, "std_msgs/msg/Empty")
    return SensorRow(sample=sample, reader=reader, parts=(name, "log"), topics=(topic,), rate=rate)


ROWS = (row("pose", Pose, 20), row("truth", TruthState, 25))


def suite(log: list[str], **told: Any) -> SensorSuite:  # noqa: ANN401 - of several types
    parts = {"pose": "pose", "truth": "truth", "log": log}
    return SensorSuite(parts, ZERO, {Pose: 50}, rows=ROWS, **told)


@pytest.mark.parametrize("since", [0, 100, 700])
def test_all_take_every_tick_into_account_and_those_that_are_due_are_read(since: int) -> None:
    log: list[str] = []
    spied = suite(log)
    told = [[type(sample) for sample in spied.tick(since + tick)] for tick in range(1, 5)]
    assert told == [[], [Pose], [], [Pose, TruthState]]
    observed = ["pose observe", "truth observe"]
    assert log == [*observed * 2, "pose read", *observed * 2, "pose read", "truth read"]
    assert {kind: sample.stamp_ns for kind, sample in spied.latest.items()} == {Pose: 10, TruthState: 11}


def test_a_reset_is_told_before_and_after_to_all_and_what_was_read_is_forgotten() -> None:
    log: list[str] = []
    spied = suite(log)
    spied.tick(100)
    log.clear()
    spied.before_reset()
    assert (log, set(spied.latest)) == (["pose before", "truth before"], {Pose, TruthState})
    spied.after_reset()
    assert (log[2:], spied.latest) == (["pose after", "truth after"], {})


def test_what_is_corrupted_is_told_and_kept_as_such() -> None:
    noise: Any = SimpleNamespace(corrupt=lambda sample: replace(sample, stamp_ns=-sample.stamp_ns))
    spied = suite([], noise=noise, wanted={Pose})
    (told,) = spied.tick(100)
    assert (told.stamp_ns, spied.latest) == (-2, {Pose: told})
    assert suite([], wanted=()).tick(100) == ()


def test_a_suite_has_all_that_its_parts_suffice_for(make_simulation: MakeSimulation) -> None:
    simulation = make_simulation()
    read = SensorSuite({"simulation": simulation}, ZERO, {})
    simulation.tick()
    kinds = {type(sample) for sample in read.tick(100)}
    assert kinds >= {Imu, Pose, Odometry, GroundTruth}
    assert "LaserScan" not in {kind.__name__ for kind in kinds}  # there is no lidar among the parts
    truth = KINDS["truth"](5)
    assert SensorSuite({"recorder": SimpleNamespace(state=lambda: truth)}, ZERO, {}).tick(5) == (truth,)
