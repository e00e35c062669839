"""What a suite asks its sensors, and when."""

from dataclasses import replace
from typing import Any

import pytest

from harness.samples import Pose, Sample, TruthState
from harness.sensors.base import EpisodeParts, Sensor
from harness.sensors.suite import SensorSuite
from harness.sensors.table import SensorRow, Topic
from tests.support.rovers import LEO

LOG: list[str] = []


class Spy(Sensor):
    """Notes what it is asked; its stamp is how much has been noted."""

    name, sample = "pose", Pose(0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))

    def observe(self) -> None:
        LOG.append(f"{self.name} observe")

    def read(self) -> Sample:
        LOG.append(f"{self.name} read")
        return replace(self.sample, stamp_ns=len(LOG))

    def before_reset(self) -> None:
        LOG.append(f"{self.name} before")

    def after_reset(self) -> None:
        LOG.append(f"{self.name} after")


class TruthSpy(Spy):
    """Another one."""

    name, sample = "truth", TruthState(0, False, False, False, 0.0, 0.0, 0.0, (), 0.0)  # type: ignore[assignment]


def row(spy: type[Spy], rate: int) -> SensorRow:
    factory, topic = f"{__name__}:{spy.__name__}", Topic(spy.name, "std_msgs/msg/Empty")
    return SensorRow(sample=type(spy.sample), factory=factory, topics=(topic,), rate=rate)


def suite() -> SensorSuite:
    LOG.clear()
    nothing: Any = None
    parts, rows = EpisodeParts(simulation=nothing), (row(Spy, 20), row(TruthSpy, 25))
    return SensorSuite(parts, LEO, {Pose: 50}, rows=rows)


@pytest.mark.parametrize("since", [0, 100, 700])
def test_all_take_every_tick_into_account_and_those_that_are_due_are_read(since: int) -> None:
    spied = suite()
    read = [[type(sample) for sample in spied.tick(since + tick)] for tick in range(1, 5)]
    assert read == [[], [Pose], [], [Pose, TruthState]]
    observed = ["pose observe", "truth observe"]
    assert [*observed * 2, "pose read", *observed * 2, "pose read", "truth read"] == LOG
    assert {kind: sample.stamp_ns for kind, sample in spied.latest.items()} == {Pose: 10, TruthState: 11}


def test_a_reset_is_announced_before_and_after_to_all_and_what_was_read_is_forgotten() -> None:
    spied = suite()
    spied.tick(100)
    LOG.clear()
    spied.before_reset()
    assert (LOG, set(spied.latest)) == (["pose before", "truth before"], {Pose, TruthState})
    spied.after_reset()
    assert (LOG[2:], spied.latest) == (["pose after", "truth after"], {})
