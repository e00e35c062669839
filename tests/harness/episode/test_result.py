from types import SimpleNamespace

import pytest

from harness.episode import result as results
from harness.episode.batch import Batch
from harness.episode.result import RunAccount, RunResult, TopicCount
from harness.spec.run import Run
from harness.truth.traversal import ContactEvent, Truth

TICK_NS = 10_000_000
EVENT = ContactEvent("rock", 0, TICK_NS, "wheel_FL", "rock_1", 5.0, (0.1, 0.2, 0.0))


def test_speeds_and_counts_of_a_run_follow_from_what_it_holds() -> None:
    result = RunResult(
        run=Run(),
        mode="direct",
        truth=Truth(time_ns=4_000_000_000, path_length=1.0),
        wall_s=0.5,
        paused_s=10.0,
        topics={"/a": TopicCount(10, 8, 2), "/b": TopicCount(30, None, 1)},
    )
    assert result.simulated_s == 4.0
    assert result.real_time_factor == pytest.approx(8.0)
    assert result.mean_speed == pytest.approx(0.25)
    assert (result.messages, result.lost) == (40, 3)


@pytest.mark.parametrize("wall_s", [0.0, 1.5])
def test_a_run_that_never_began_or_failed_in_its_first_tick_has_no_speeds(wall_s: float) -> None:
    result = RunResult(run=Run(), mode="direct", wall_s=wall_s)
    assert (result.real_time_factor, result.mean_speed, result.messages, result.lost) == (0, 0, 0, 0)


def test_an_account_leaves_pauses_out_of_the_wall_time_and_has_the_first_row_since_the_start(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wall = iter((10.0, 13.0, 17.0, 21.0))  # made, and at each batch
    monkeypatch.setattr(results, "time", SimpleNamespace(monotonic=lambda: next(wall)))
    told = list[RunResult]()
    result = RunResult(run=Run.of(duration=2.0), mode="")
    account = RunAccount(
        result, 4.0, told.append, lambda: {"/a": TopicCount(7)}, lambda: len(told), lambda: 2.0
    )
    assert account.ended().paused_s == 0.0
    truths = [Truth(last * TICK_NS, path_length=0.1 * last) for last in (2, 4, 6)]
    for truth in truths:
        account.take(Batch((), truth, (EVENT,)))
    ended = account.ended(failure="it fell off", interrupted="SIGINT")
    assert (ended.wall_s, ended.paused_s, ended.first_row_s) == (9.0, 2.0, 13.0)
    assert (ended.truth, ended.failure, ended.interrupted) == (truths[-1], "it fell off", "SIGINT")
    assert ended.along.event_count == 3
    assert [progress.wall_s for progress in told] == [1.0, 5.0, 9.0]
    assert (told[0].simulated_s, told[0].messages, told[0].rows) == (0.02, 7, 0)
    assert told[0].truth.path_length == pytest.approx(0.2)
