"""A direct run over a scripted episode: what becomes of its ticks, its progress and its end."""

import csv
import json
import signal
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.base.errors import RunFailed, UsageError
from harness.base.interrupt import StopRequest
from harness.episode import direct
from harness.episode import result as results
from harness.episode.batch import Batch, EpisodeInfo
from harness.episode.result import RunResult
from harness.samples import GroundTruth, Imu, LaserScan, Odometry, Pose, Sample, Tick, TruthState, Twist
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from harness.truth.traversal import ContactEvent, Truth
from rover_metrics.extended.settings import Settings

TICK_NS, BATCH_NS = 10_000_000, 50_000_000
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
INFO = EpisodeInfo("model", "terrain", 3, (40.0, 40.0), (0.0, 0.0, 0.0))
EVENT = ContactEvent("rock", 0, TICK_NS, "wheel_FL", "rock_1", 5.0, (0.1, 0.2, 0.0))


def samples(stamp: int) -> tuple[Sample, ...]:
    """What a tick at the end of a batch carries; the rover drives at 0.4 m/s for the first second."""
    second = stamp / 1e9
    return (
        LaserScan(stamp, np.full(8, 2.0 + second, dtype=np.float32)),
        Imu(stamp, UPRIGHT, (0.0, 0.0, 0.5), (0.3, 0.0, 9.8)),
        Pose(stamp, (0.4 * min(second, 1.0), 0.0, 0.0), UPRIGHT),
        Odometry(stamp, 0.0, 0.0, 0.0, Twist(0.4 if second <= 1.0 else 0.2, 0.0)),
        GroundTruth(stamp, 0.0, 0.0, 0.0, (0.4, 0.0, 0.0), (0.0, 0.0, 0.0)),
        TruthState(stamp, False, False, False, 0.0, 0.4, 0.0, (0.0,) * 4, 0.0),
    )


class Scripted:
    """An episode of 2 s that needs no physics; `failure` ends it after its last batch."""

    failure: RunFailed | None = None

    def __init__(self, _: Run) -> None:
        self.info = INFO

    def batches(self) -> Iterator[Batch]:
        for index in range(1, 41):
            stamps = [(index - 1) * BATCH_NS + n * TICK_NS for n in range(1, 6)]
            ticks = (*(Tick(s, ()) for s in stamps[:-1]), Tick(stamps[-1], samples(stamps[-1])))
            truth = Truth(time_ns=stamps[-1], path_length=0.02 * index)
            yield Batch(ticks, truth, (EVENT,) if index == 7 else ())
        if self.failure is not None:
            raise self.failure


@pytest.fixture(autouse=True)
def scripted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Episodes are scripted, and each reading of the wall clock is a quarter of a second later."""
    wall = iter(range(10_000))
    monkeypatch.setattr(direct, "fleet_of", lambda configs: [Scripted(config) for config in configs])
    monkeypatch.setattr(direct, "together", lambda made: ((batch,) for batch in made[0].batches()))
    for module in (direct, results):
        monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: next(wall) / 4))


Run = Callable[..., RunResult]


@dataclass
class Watching:
    """An observer that hands each batch on."""

    take: Callable[[Batch], None]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    def one(
        *,
        show: Callable[[RunResult], None] | None = None,
        watch: Callable[[Batch], None] | None = None,
        stop: Any = None,  # noqa: ANN401 - a stop request or a stand-in
        settings: Settings = direct.DEFAULT_SETTINGS,
        **changes: Any,  # noqa: ANN401 - of the configuration
    ) -> RunResult:
        config = Run.of(**{"duration": 2.0, "lidar_beams": 8, **changes})
        request = StopRequest() if stop is None else stop
        observers = [] if watch is None else [Watching(watch)]
        return direct.run_direct(
            config, RosOptions(log_dir=tmp_path), request, show, observers, settings
        )

    return one


def rows(result: RunResult) -> list[dict[str, str]]:
    assert result.log_path is not None
    with result.log_path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_each_full_second_has_a_row_that_knows_the_samples_of_its_own_tick(run: Run) -> None:
    result = run()
    first, second = rows(result)
    assert (first["Timestamp"], second["Timestamp"]) == ("1", "2")
    assert float(first["Distance Traveled"]) == pytest.approx(0.38)  # from 0.05 s to 1 s
    assert float(first["Current Velocity"]) == pytest.approx(0.4)
    assert float(second["Current Velocity"]) == pytest.approx(0.3)
    assert float(first["Obstacle Clearance"]) == pytest.approx(2.525)
    assert float(first["IMU Acceleration Magnitude"]) == pytest.approx(9.8046, abs=1e-4)
    assert float(first["Current Smoothness"]) == pytest.approx(9.8046 + 0.5, abs=1e-4)
    assert result.rows == 2
    assert result.last_row is not None
    assert result.last_row["Timestamp"] == 2


def test_it_counts_the_samples_that_it_takes(run: Run) -> None:
    topics = {name: (c.published, c.received, c.lost) for name, c in run().topics.items()}
    names = ["/scan", "/imu/data", "/rover/pose_array", "/odometry/wheels"]
    assert topics == dict.fromkeys(names, (40, 40, 0))
    truth = ["/odom_ground_truth", "/rover/truth/contact", "/rover/truth/traversal"]
    assert list(run(settings=Settings(extended_columns=True)).topics) == [*names, *truth]


def test_the_result_says_what_was_run_and_how_it_went(run: Run) -> None:
    result = run(seed=4)
    assert (result.config.seed, result.info, result.mode) == (4, INFO, "direct, no ROS")
    assert (result.failure, result.interrupted) == (None, None)
    assert result.simulated_s == 2.0
    assert result.truth.path_length == pytest.approx(0.8)
    assert (result.along.events, result.along.event_count) == ((EVENT,), 1)
    assert result.wall_s == 10.0, "forty batches from the first on"
    assert result.first_row_s == 5.25, "the twentieth batch, from the very beginning on"


def test_progress_and_batches_are_told_as_they_come(run: Run) -> None:
    told: list[RunResult] = []
    seen: list[Batch] = []
    run(show=told.append, watch=seen.append)
    assert len(told) == len(seen) == 40
    assert (told[9].simulated_s, told[9].wall_s, told[9].messages) == (0.5, 2.5, 40)
    assert told[9].truth.path_length == pytest.approx(0.2)
    assert told[9].real_time_factor == pytest.approx(0.2)


def test_faults_stand_between_samples_and_metrics_and_the_truth_is_watched_without_them(
    run: Run,
) -> None:
    seen: list[Batch] = []
    result = run(faults=("imu:dropout@1", "clock:freeze@1.5"), watch=seen.append)
    assert result.topics["/imu/data"].published == 19
    assert [row["Timestamp"] for row in rows(result)] == ["1"]
    assert all(len(batch.ticks[-1].samples) == 6 for batch in seen)


def test_every_tick_waits_for_its_time(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    waits: list[int] = []
    pacer = SimpleNamespace(wait_until=waits.append)
    monkeypatch.setattr(direct, "Pacer", lambda *_, **__: pacer)
    run()
    assert waits == [TICK_NS * n for n in range(1, 201)]


def test_a_stop_ends_the_run_after_the_batch_in_hand(run: Run) -> None:
    stop = StopRequest()

    def show(progress: RunResult) -> None:
        if progress.simulated_s >= 1.2:
            stop.signal = signal.SIGTERM

    result = run(show=show, stop=stop)
    stop.signal = None
    assert result.interrupted == "SIGTERM"
    assert result.simulated_s == pytest.approx(1.2)
    assert result.rows == 1


@pytest.mark.parametrize("error", [None, RunFailed("the rover fell off")])
def test_how_it_ended_stands_in_the_result_and_beside_the_log(
    error: RunFailed | None, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Scripted, "failure", error)
    during: list[dict[str, Any]] = []

    def watch(_: Batch) -> None:
        if not during:
            (record,) = tmp_path.glob("*.json")
            during.append(json.loads(record.read_text())["outcome"])

    result = run(watch=watch)
    assert result.failure == (None if error is None else "the rover fell off")
    assert result.simulated_s == 2.0
    assert result.rows == 2
    assert result.log_path is not None
    outcome = json.loads(result.log_path.with_suffix(".json").read_text())["outcome"]
    assert outcome["status"] == ("complete" if error is None else "failed")
    assert during[0] != outcome


def test_a_log_that_cannot_be_made_is_a_usage_error(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(UsageError, match="file stands where a folder"), StopRequest() as stop:
        direct.run_direct(Run(), RosOptions(log_dir=tmp_path / "file"), stop)
