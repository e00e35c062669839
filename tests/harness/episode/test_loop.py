"""The loop over scripted batches: who gets what, and when; and how fast it may go."""

from dataclasses import replace
from inspect import GEN_CLOSED, getgeneratorstate

import pytest

from harness.episode.batch import Batch, later
from harness.episode.loop import Pacer, Route, drive
from harness.faults.injector import FaultInjector
from harness.samples import ContactEvent, Place, Pose, Tick, Truth
from tests.support.words import parse_faults

TICK_NS, SECOND = 10_000_000, 1_000_000_000


def tick(number: int) -> Tick:
    return Tick(number * TICK_NS, (Pose(number * TICK_NS, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)),))


BATCHES = tuple(Batch((tick(n), tick(n + 1)), Truth((n + 1) * TICK_NS)) for n in (1, 3))


class Diary:
    """A sink and two observers that write down what they are given, in one list."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.observers = Seen("a", self.lines), Seen("b", self.lines)

    def sink(self, of_episode: Tick, sent: Tick) -> None:
        self.lines.append(f"{of_episode.stamp_ns // TICK_NS}: {len(sent.samples)}")


class Seen:
    def __init__(self, name: str, lines: list[str]) -> None:
        self.name, self.lines = name, lines

    def take(self, taken: Batch) -> None:
        self.lines.append(f"{self.name} {taken.truth.time_ns // TICK_NS}")


def test_each_rovers_tick_goes_through_its_faults_to_its_sink_then_its_batch_to_its_observers() -> None:
    one, other = Diary(), Diary()
    doubled = [
        replace(b, ticks=tuple(replace(t, samples=t.samples * 2) for t in b.ticks)) for b in BATCHES
    ]
    routes = (
        Route(FaultInjector((), 0), one.sink, one.observers),
        Route(FaultInjector(parse_faults(("pose:dropout@0.03",)), 0), other.sink, other.observers[:1]),
    )
    for given in drive((each for each in zip(BATCHES, doubled, strict=True)), routes):
        one.lines.append(f"given {given.stamp_ns // TICK_NS}")
        assert len(given.samples) == 1, "those of the first rover"
    assert one.lines == [
        *("1: 1", "given 1", "2: 1", "given 2", "a 2", "b 2"),
        *("3: 1", "given 3", "4: 1", "given 4", "a 4", "b 4"),
    ]
    assert other.lines == ["1: 2", "2: 2", "a 2", "3: 0", "4: 0", "a 4"]


def test_a_bug_of_an_observer_ends_what_makes_the_batches() -> None:
    class Buggy:
        def take(self, taken: Batch) -> None:
            raise ValueError(taken)

    made = ((batch,) for batch in BATCHES)
    with pytest.raises(ValueError):  # noqa: PT011 - as a program shows it: the frames are still there
        list(drive(made, [Route(FaultInjector((), 0), lambda *_: None, (Buggy(),))]))
    assert getgeneratorstate(made) == GEN_CLOSED, "else a second core simulates on at the end"


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
    ("rate", "gone_s", "paused_s", "waits_s"),
    [
        (1.0, 0.25, 0.0, [0.75]),
        (2.0, 0.0, 0.0, [0.5]),
        (0.5, 0.5, 0.0, [1.5]),
        (2.0, 1.0, 0.0, []),
        (None, 0.0, 0.0, []),
        (1.0, 7.0, 7.0, [1.0]),  # a pause is not caught up with
    ],
)
def test_it_waits_until_wall_time_has_caught_up_with_a_second_of_simulation(
    rate: float | None, gone_s: float, paused_s: float, waits_s: list[float]
) -> None:
    time = FakeTime()
    pacer = Pacer(rate, time.clock, time.sleep)
    time.now_ns += round(gone_s * SECOND)
    pacer.postpone(paused_s)
    pacer.wait_until(SECOND)
    assert time.slept == pytest.approx(waits_s)


def test_a_later_batch_has_all_its_times_moved_and_nothing_else() -> None:
    event = ContactEvent("rock", TICK_NS, 2 * TICK_NS, "wheel_FL", "rock_1", 5.0, (0.1, 0.2, 0.0))
    goal = Place(1.0, 2.0, 3.0)

    def batch(by: int) -> Batch:
        ended, lasting = (
            replace(event, start_ns=event.start_ns + by, end_ns=event.end_ns + n + by) for n in (0, 7)
        )
        stamped = Tick(TICK_NS + by, tuple(replace(s, stamp_ns=TICK_NS + by) for s in tick(1).samples))
        return Batch((stamped,), Truth(2 * TICK_NS + by, 0.5), (ended,), (lasting,), (goal,))

    assert later(batch(0), 5 * SECOND) == batch(5 * SECOND)
    assert later(batch(3), 0) == batch(3)
