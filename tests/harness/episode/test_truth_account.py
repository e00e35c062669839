import math

import pytest

from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.episode.truth_account import TruthAccount
from harness.samples import ContactEvent, Pose, Tick, Truth, TruthState

MOST_POINTS, MOST_EVENTS = 10, 8


def event(second: float) -> ContactEvent:
    start = round(second * NANOSECONDS)
    return ContactEvent("rock", start, start + 10_000_000, "wheel_FL", "rock_1", 5.0, (0.1, 0.2, 0.0))


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Limits that a test reaches in milliseconds."""
    monkeypatch.setattr("harness.episode.truth_account.MOST_POINTS", MOST_POINTS)
    monkeypatch.setattr("harness.episode.truth_account.MOST_EVENTS", MOST_EVENTS)


def batch(second: float, roughness: float = 0.0) -> Batch:
    """Of one tick, whose last sample is the truth."""
    stamp = round(second * NANOSECONDS)
    state = TruthState(stamp, False, False, False, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0, 0.0), roughness)
    pose = Pose(stamp, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    truth = Truth(time_ns=stamp, position=(second, 0.0, 0.0))
    return Batch((Tick(stamp, ()), Tick(stamp, (pose, state))), truth)


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


def test_the_first_events_are_kept_all_are_counted_and_those_that_last_are_told_as_they_stand() -> None:
    account = TruthAccount()
    for ended, lasting, kept, count in (
        ([0], [1], [0, 1], 2),
        ([], [], [0], 1),  # which is no event after all
        ([*range(1, MOST_EVENTS - 1)], [], [*range(MOST_EVENTS - 1)], MOST_EVENTS - 1),
        ([], [70, 71], [*range(MOST_EVENTS - 1), 70], MOST_EVENTS + 1),
        ([90, 91], [92], [*range(MOST_EVENTS - 1), 90], MOST_EVENTS + 2),
        ([93], [94, 95], [*range(MOST_EVENTS - 1), 90], MOST_EVENTS + 4),
    ):
        account.take(Batch((), Truth(), tuple(map(event, ended)), tuple(map(event, lasting))))
        along = account.along()
        assert along.events == tuple(map(event, kept))
        assert along.event_count == count


@pytest.mark.parametrize(
    ("values", "p50", "p95"),
    [
        ([0.00314], 0.0031, 0.0031),  # told to a tenth of a millimetre
        ([0.00316], 0.0032, 0.0032),
        ([0.001] * 19 + [0.002], 0.001, 0.001),
        ([0.001] * 18 + [0.002] * 2, 0.001, 0.002),
        ([0.001, 0.002], 0.001, 0.002),
        ([0.002] * 90 + [0.05] * 10, 0.002, 0.05),
        ([5.0], 1.0, 1.0),  # what is rougher than a metre counts as one
        ([], math.nan, math.nan),
    ],
)
def test_percentiles_of_roughness(values: list[float], p50: float, p95: float) -> None:
    account = TruthAccount()
    for index, value in enumerate(values):
        account.take(batch(index, roughness=value))
    along = account.along()
    assert (along.roughness_p50, along.roughness_p95) == pytest.approx((p50, p95), nan_ok=True)
