"""The loop over a scripted episode: who is told what, and when."""

import signal
from dataclasses import replace
from types import SimpleNamespace

import pytest

from harness.config import EpisodeConfig
from harness.episode import loop
from harness.episode.batch import Batch
from harness.episode.loop import RunAccount, drive
from harness.episode.result import Progress, RunResult
from harness.faults.injector import FaultInjector
from harness.faults.spec import parse_faults
from harness.interrupt import StopRequest
from harness.samples import Pose, Tick
from harness.truth.traversal import ContactEvent, Truth

TICK_NS = 10_000_000
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


def test_a_stop_ends_the_drive_once_the_batch_in_hand_has_been_taken() -> None:
    diary, stop = Diary(), StopRequest()
    for _ in drive(BATCHES, FaultInjector((), 0), diary.sink, diary.observers, stop):
        stop.signal = signal.SIGINT
    assert diary.told == ["1: 1", "2: 1", "a 2", "b 2"]


def test_an_account_leaves_pauses_out_of_the_wall_time_and_has_the_first_row_since_the_start(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wall = iter((10.0, 13.0, 17.0, 21.0))  # made, and at each batch
    monkeypatch.setattr(loop, "time", SimpleNamespace(monotonic=lambda: next(wall)))
    rows, told = iter((0, 1)), list[Progress]()
    result = RunResult(config=EpisodeConfig(duration=2.0), mode="")
    account = RunAccount(result, 4.0, told.append, lambda: 7, lambda: next(rows), lambda: 2.0)
    for taken in (*BATCHES, batch(5, 6)):
        account.take(taken)
    ended = account.ended(failure="it fell off", interrupted="SIGINT")
    assert (ended.wall_s, ended.paused_s, ended.first_row_s) == (9.0, 2.0, 13.0)
    assert (ended.truth, ended.failure, ended.interrupted) == (
        batch(5, 6).truth,
        "it fell off",
        "SIGINT",
    )
    assert ended.along.event_count == 3
    assert [progress.wall_s for progress in told] == [1.0, 5.0, 9.0]
    assert replace(told[0], path_length=0.0) == Progress(0.02, 2.0, 1.0, 0.0, 7)
    assert told[0].path_length == pytest.approx(0.2)
