import math
from dataclasses import replace

import pytest

from harness.episode.batch import Batch
from harness.episode.truth_account import TruthAccount
from harness.samples import Pose, Tick, TruthState
from harness.sim_time import NANOSECONDS
from harness.truth.traversal import ContactEvent, Truth

MOST_POINTS, MOST_EVENTS = 10, 8


def event(second: float) -> ContactEvent:
    start = round(second * NANOSECONDS)
    return ContactEvent("rock", start, start + 10_000_000, "wheel_FL", "rock_1", 5.0, (0.1, 0.2, 0.0))


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Limits that a test reaches in milliseconds."""
    monkeypatch.setattr("harness.episode.truth_account.MOST_POINTS", MOST_POINTS)
    monkeypatch.setattr("harness.episode.truth_account.MOST_EVENTS", MOST_EVENTS)


def batch(second: float, roughness: float = 0.0, events: tuple[ContactEvent, ...] = ()) -> Batch:
    stamp = round(second * NANOSECONDS)
    state = TruthState(stamp, False, False, False, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0, 0.0), roughness)
    truth = Truth(time_ns=stamp, position=(second, 0.0, 0.0))
    return Batch((Tick(stamp, (state,)),), truth, events)


def test_roughness_is_weighted_by_time() -> None:
    account = TruthAccount()
    for index in range(100):
        account.take(batch(index, roughness=0.002 if index < 90 else 0.05))
    along = account.along()
    assert along.roughness_p50 == pytest.approx(0.002)
    assert along.roughness_p95 == pytest.approx(0.05)
    assert math.isnan(TruthAccount().along().roughness_p50)


def test_the_path_has_a_point_each_second_and_thins_out_before_it_grows_too_long() -> None:
    account = TruthAccount()
    for twentieth in range(1, 60):
        account.take(batch(twentieth / 20))
    assert [x for x, _, _ in account.along().path] == [1.0, 2.0]
    for second in range(3, 3 * MOST_POINTS):
        account.take(batch(second))
        assert len(account.along().path) < MOST_POINTS
    along = account.along()
    assert along.path_period_s == 4.0
    assert [x for x, _, _ in along.path] == [4.0 * n for n in range(1, len(along.path) + 1)]
    assert along.path[-1][0] == 28.0, "the last multiple of 4 s"


def test_events_are_counted_beyond_those_that_are_kept() -> None:
    account = TruthAccount()
    for second in range(MOST_EVENTS + 5):
        account.take(batch(second, events=(event(second),)))
    along = account.along()
    assert (len(along.events), along.event_count) == (MOST_EVENTS, MOST_EVENTS + 5)
    assert along.events[-1].start_ns == (MOST_EVENTS - 1) * NANOSECONDS
    account.take(Batch((), Truth(), open_events=(event(99.0),)))
    along = account.along()
    assert (len(along.events), along.event_count) == (MOST_EVENTS, MOST_EVENTS + 6)


def test_a_batch_that_ends_more_events_than_there_is_room_for_gives_its_first() -> None:
    account = TruthAccount()
    account.take(Batch((), Truth(), tuple(event(second) for second in range(MOST_EVENTS - 1))))
    account.take(Batch((), Truth(), (event(90.0), event(91.0)), open_events=(event(92.0),)))
    along = account.along()
    assert [e.start_ns // NANOSECONDS for e in along.events] == [*range(MOST_EVENTS - 1), 90]
    assert along.event_count == MOST_EVENTS + 2


def test_the_truth_is_the_last_sample_of_a_tick() -> None:
    account, told = TruthAccount(), batch(1.0, roughness=0.004)
    (tick,) = told.ticks
    pose = Pose(tick.stamp_ns, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    account.take(replace(told, ticks=(Tick(tick.stamp_ns, (pose, *tick.samples)),)))
    assert account.along().roughness_p50 == pytest.approx(0.004)


@pytest.mark.parametrize(
    ("values", "p50", "p95"),
    [
        ([0.00314], 0.0031, 0.0031),  # told to a tenth of a millimetre
        ([0.00316], 0.0032, 0.0032),
        ([0.001] * 19 + [0.002], 0.001, 0.001),
        ([0.001] * 18 + [0.002] * 2, 0.001, 0.002),
        ([0.001, 0.002], 0.001, 0.002),
        ([5.0], 1.0, 1.0),  # what is rougher than a metre counts as one
    ],
)
def test_percentiles_of_roughness(values: list[float], p50: float, p95: float) -> None:
    account = TruthAccount()
    for index, value in enumerate(values):
        account.take(batch(index, roughness=value))
    along = account.along()
    assert (along.roughness_p50, along.roughness_p95) == pytest.approx((p50, p95))


def test_an_interrupted_run_has_the_events_that_lasted() -> None:
    account = TruthAccount()
    account.take(Batch((), Truth(), (event(1.0),), open_events=(event(2.0),)))
    along = account.along()
    assert along.events == (event(1.0), event(2.0))
    assert along.event_count == 2
    account.take(Batch((), Truth()))
    assert account.along().events == (event(1.0),)
