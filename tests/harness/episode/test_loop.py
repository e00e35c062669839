"""The loop over a scripted episode: who is told what, and when; and how fast it may go."""

import signal
from dataclasses import replace
from typing import Any

import pytest

from harness.base.interrupt import StopRequest
from harness.episode import loop
from harness.episode.batch import Batch
from harness.episode.loop import Lane, Pacer, drive, drive_all, injector
from harness.faults.injector import FaultInjector
from harness.samples import Pose, Tick
from harness.spec.run import Run
from harness.truth.traversal import ContactEvent, Truth
from tests.support.words import parse_faults

TICK_NS, SECOND = 10_000_000, 1_000_000_000
EVENT = ContactEvent("rock", 0, TICK_NS, "wheel_FL", "rock_1", 5.0, (0.1, 0.2, 0.0))


def tick(number: int) -> Tick:
    return Tick(number * TICK_NS, (Pose(number * TICK_NS, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)),))


def batch(first: int, last: int) -> Batch:
    truth = Truth(last * TICK_NS, path_length=0.1 * last)
    return Batch(tuple(map(tick, range(first, last + 1))), truth, (EVENT,))


BATCHES = (batch(1, 2), batch(3, 4))


class Diary:
    """A sink and two observers that write down what they are told, in one list."""

    def __init__(self) -> None:
        self.told: list[str] = []
        self.observers = (self._observer("a"), self._observer("b"))

    def sink(self, of_episode: Tick, sent: Tick) -> None:
        self.told.append(f"{of_episode.stamp_ns // TICK_NS}: {len(sent.samples)}")

    def _observer(self, name: str) -> "Seen":
        return Seen(name, self.told)


class Seen:
    def __init__(self, name: str, told: list[str]) -> None:
        self.name, self.told = name, told

    def take(self, taken: Batch) -> None:
        self.told.append(f"{self.name} {taken.truth.time_ns // TICK_NS}")


def test_each_tick_goes_to_the_sink_and_then_each_batch_to_the_observers_in_their_order() -> None:
    diary = Diary()
    for given in drive(BATCHES, FaultInjector((), 0), diary.sink, diary.observers):
        diary.told.append(f"given {given.stamp_ns // TICK_NS}")
    assert diary.told == [
        *("1: 1", "given 1", "2: 1", "given 2", "a 2", "b 2"),
        *("3: 1", "given 3", "4: 1", "given 4", "a 4", "b 4"),
    ]


def test_faults_change_what_is_sent_and_not_the_episode() -> None:
    diary, faults = Diary(), FaultInjector(parse_faults(("pose:dropout@0.03",)), 0)
    ticks = list(drive(BATCHES, faults, diary.sink))
    assert diary.told == ["1: 1", "2: 1", "3: 0", "4: 0"]
    assert ticks == [tick(number) for number in range(1, 5)]


def test_each_of_several_rovers_has_faults_a_sink_and_observers_of_its_own() -> None:
    one, other = Diary(), Diary()
    others = [
        replace(b, ticks=tuple(replace(t, samples=t.samples * 2) for t in b.ticks)) for b in BATCHES
    ]
    lanes = (
        Lane(FaultInjector((), 0), one.sink, one.observers[:1]),
        Lane(FaultInjector(parse_faults(("pose:dropout@0.03",)), 0), other.sink, other.observers),
    )
    ticks = list(drive_all(zip(BATCHES, others, strict=True), lanes))
    assert ticks == [tick(number) for number in range(1, 5)], "those of the first rover"
    assert one.told == ["1: 1", "2: 1", "a 2", "3: 1", "4: 1", "a 4"]
    assert other.told == ["1: 2", "2: 2", "a 2", "b 2", "3: 0", "4: 0", "a 4", "b 4"]


def test_the_faults_of_a_rover_are_drawn_from_its_own_seed_but_the_clocks_from_that_of_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(loop, "FaultInjector", lambda *given: given)
    config = Run.of(seed=5, name="b", number=2, faults=("imu:nan@1", "clock:jump=10@2"))
    rows = config.sensor_rows()
    assert config.own_seed != 5
    given: Any = injector(config)
    assert given == (parse_faults(config.faults, rows), config.own_seed, rows, 5)


def test_a_stop_ends_the_drive_once_the_batch_in_hand_has_been_taken() -> None:
    diary, stop = Diary(), StopRequest()
    for _ in drive(BATCHES, FaultInjector((), 0), diary.sink, diary.observers, stop):
        stop.signal = signal.SIGINT
    assert diary.told == ["1: 1", "2: 1", "a 2", "b 2"]


class FakeTime:
    def __init__(self) -> None:
        self.now_ns = 5 * SECOND
        self.slept: list[float] = []

    def clock(self) -> int:
        return self.now_ns

    def sleep(self, seconds: float) -> None:
        self.slept.append(seconds)
        self.now_ns += round(seconds * SECOND)


@pytest.mark.parametrize(
    ("rate", "gone_s", "waits_s"),
    [(1.0, 0.25, [0.75]), (2.0, 0.0, [0.5]), (0.5, 0.5, [1.5]), (2.0, 1.0, []), (None, 0.0, [])],
)
def test_it_waits_until_wall_time_has_caught_up_with_a_second_of_simulation(
    rate: float | None, gone_s: float, waits_s: list[float]
) -> None:
    time = FakeTime()
    pacer = Pacer(rate, time.clock, time.sleep)
    time.now_ns += round(gone_s * SECOND)
    pacer.wait_until(SECOND)
    assert time.slept == pytest.approx(waits_s)


def test_a_pause_is_not_caught_up_with() -> None:
    time = FakeTime()
    pacer = Pacer(1.0, time.clock, time.sleep)
    time.now_ns += 7 * SECOND
    pacer.postpone(7.0)
    pacer.wait_until(SECOND)
    assert time.slept == pytest.approx([1.0])
