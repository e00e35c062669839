"""A run without ROS: what stands in its log and its result, whichever way it ends."""

import csv
import json
import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import Mock

import pytest

from harness.base.errors import UsageError
from harness.base.interrupt import StopRequest
from harness.episode.assembly import fleet
from harness.episode.batch import Batch
from harness.episode.direct import run_direct, run_unlogged
from harness.episode.episode import Episode
from harness.episode.result import Outputs, RunResult
from harness.episode.run import run_episode
from harness.samples import TruthState
from harness.spec.fleet import parse_rovers
from harness.spec.ros import RosOptions
from harness.spec.run import Run

FLAT = {"terrain": "flat", "driver": "straight", "duration": 2.0, "lidar_beams": 8}


@dataclass
class Watching:
    """An observer that hands each batch on."""

    take: Callable[[Batch], None]


def drive(
    folder: Path,
    stop: StopRequest | None = None,
    show: Callable[[RunResult], None] | None = None,
    watch: Callable[[Batch], None] = lambda _: None,
    **values: object,
) -> RunResult:
    outputs = [Outputs(log_dir=folder, observers=(Watching(watch),))]
    options = RosOptions(log_dir=folder)
    (result,) = run_direct(Run.of(**FLAT | values), outputs, options, stop or StopRequest(), show)
    return result


def timestamps(result: RunResult) -> list[str]:
    assert result.log_path is not None
    with result.log_path.open(newline="") as file:
        return [row["Timestamp"] for row in csv.DictReader(file)]


def outcome(folder: Path) -> str:
    """What the record beside the log says of its end; "" while there is none."""
    (record,) = folder.glob("*.json")
    ended = json.loads(record.read_text())["outcome"]
    return "" if ended is None else str(ended["status"])


@pytest.fixture(autouse=True)
def every_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shows the result of each, however fast they come."""
    monkeypatch.setattr("harness.episode.result.SHOWN_EVERY", 0.0)


def test_progress_is_shown_as_it_comes_and_the_log_is_marked_from_its_beginning(
    tmp_path: Path,
) -> None:
    shown: list[RunResult] = []
    marks: set[str] = set()
    result = drive(tmp_path, show=shown.append, watch=lambda _: marks.add(outcome(tmp_path)))
    assert [each.truth.time_ns for each in shown] == [50_000_000 * n for n in range(1, 41)]
    assert [each.rows for each in shown[18:20]] == [0, 1]
    assert [each.messages for each in shown[:2]] == [5, 11]
    assert timestamps(result) == ["1", "2"]
    assert (result.failure, result.interrupted, result.segments) == (None, None, None)
    assert result.first_row_s is not None
    assert (marks, outcome(tmp_path)) == ({""}, "complete")


def test_a_fault_changes_what_is_logged_and_not_what_observers_see(tmp_path: Path) -> None:
    seen: list[Batch] = []
    result = drive(tmp_path, watch=seen.append, faults=("imu:dropout@1", "clock:freeze@1.5"))
    assert result.topics["/imu/data"].published == 19
    assert timestamps(result) == ["1"]
    assert all(len(batch.ticks[-1].samples) >= 3 for batch in seen)


def test_a_stop_ends_the_run_after_the_batch_in_hand_and_keeps_its_rows(tmp_path: Path) -> None:
    stop = StopRequest()

    def stop_it(progress: RunResult) -> None:
        if progress.simulated_s >= 1.2:
            stop.signal = signal.SIGTERM

    result = drive(tmp_path, stop, stop_it)
    stop.signal = None
    assert (result.interrupted, result.truth.time_ns) == ("SIGTERM", 1_200_000_000)
    assert timestamps(result) == ["1"]
    stopper = Mock(take=lambda _: setattr(stop, "signal", signal.SIGINT))
    unlogged = run_unlogged(result.run, stop, {TruthState}, (stopper,))
    assert (unlogged.interrupted, unlogged.truth.time_ns) == ("SIGINT", 50_000_000)


def test_a_run_that_fails_keeps_its_rows_and_says_why(tmp_path: Path) -> None:
    run = Run.of(**FLAT | {"start": (18.5, 0.0, 0.0), "duration": 20.0})
    (result,) = run_direct(run, [Outputs(log_dir=tmp_path)], RosOptions(log_dir=tmp_path), StopRequest())
    assert result.failure is not None
    assert "edge of the map" in result.failure
    assert timestamps(result) == [str(n + 1) for n in range(result.truth.time_ns // 1_000_000_000)]
    assert outcome(tmp_path) == "failed"
    unlogged = run_unlogged(run, StopRequest(), {TruthState}, ())
    assert (unlogged.failure, unlogged.info, unlogged.truth) == (
        result.failure,
        result.info,
        result.truth,
    )


def test_a_paced_run_takes_at_least_as_long_as_its_rate_says(tmp_path: Path) -> None:
    run, options = Run.of(**FLAT | {"duration": 0.3}), RosOptions(log_dir=tmp_path, rate=0.5)
    (result,) = run_direct(run, [Outputs(log_dir=tmp_path)], options, StopRequest())
    assert result.wall_s > 0.5


def test_of_several_rovers_the_first_is_shown_and_each_has_a_result(tmp_path: Path) -> None:
    run, shown = Run.of(**FLAT | {"duration": 0.1}), list[RunResult]()
    two = fleet(run, parse_rovers(("leo:a", "leo:b,x=2,y=0"), run.rover))
    outputs = [Outputs(log_dir=tmp_path / name) for name in "ab"]
    results = run_direct(two, outputs, RosOptions(log_dir=tmp_path), StopRequest(), shown.append)
    assert [each.number for each in results] == [0, 1]
    assert [each.number for each in shown] == [0, 0]


def test_what_drives_a_single_rover_says_so_of_several(tmp_path: Path) -> None:
    run = Run.of(**FLAT)
    two = fleet(run, parse_rovers(("leo:a", "leo:b,x=2,y=0"), run.rover))
    for drives in (Episode, lambda run: run_episode(run, tmp_path / "logs")):
        with pytest.raises(UsageError, match=r"single rover, not a, b; .* --rover"):
            drives(two)
    assert list(tmp_path.iterdir()) == []


def test_without_a_log_the_drive_is_the_same_whatever_its_observers_want(tmp_path: Path) -> None:
    logged = drive(tmp_path, terrain="posts", driver="wander", lidar_beams=60, seed=3, duration=4.0)
    unlogged = run_unlogged(logged.run, StopRequest(), set(), ())
    assert unlogged.truth.position == logged.truth.position
