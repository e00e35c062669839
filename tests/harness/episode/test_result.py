"""What a run comes to, and the manifest of it."""

import json
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from harness.base.errors import UsageError
from harness.episode import result as results
from harness.episode.batch import Batch, EpisodeInfo
from harness.episode.manifest import manifest, write_manifest
from harness.episode.result import RunAccount, RunResult, TopicCount
from harness.episode.truth_account import TruthAlong
from harness.samples import ContactEvent, Truth
from harness.spec.run import Run
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS
from rover_metrics.log.session_record import session_thresholds
from tests.support.snapshots import check_snapshot

TICK_NS = 10_000_000
EVENT = ContactEvent("rock", 0, TICK_NS, "wheel_FL", "rock_1", 5.0, (0.1, 0.2, 0.0))


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


def result(**changes: object) -> RunResult:
    values: dict[str, object] = {
        "run": Run.of(seed=7),
        "mode": "direct",
        "truth": Truth(time_ns=2_000_000_000, path_length=0.8),
        "wall_s": 0.5,
        "topics": {"/scan": TopicCount(published=40, received=40)},
        "last_row": {"Obstacle Clearance": math.inf},
    }
    return RunResult(**{**values, **changes})  # type: ignore[arg-type]  # a table of keywords


def test_written_manifest_is_valid_json_with_infinities_as_null(tmp_path: Path) -> None:
    write_manifest(result(), tmp_path / "run.json")
    read = json.loads((tmp_path / "run.json").read_text())
    assert read["arguments"]["seed"] == 7
    assert read["real_time_factor"] == pytest.approx(4.0)
    assert read["truth"]["time_s"] == pytest.approx(2.0)
    assert read["last_row"]["Obstacle Clearance"] is None
    assert read["versions"]["mujoco"]
    assert session_thresholds(tmp_path / "run.csv") == DEFAULT_THRESHOLDS
    assert [path.name for path in tmp_path.iterdir()] == ["run.json"]
    write_manifest(
        result(along=TruthAlong(path=((0.0, 0.0, 0.1), (0.4, 0.0, 0.1)))), tmp_path / "a.json"
    )
    assert "[ 0.4, 0.0, 0.1 ]" in (tmp_path / "a.json").read_text(), "a point of the path takes one line"


def test_a_heightmap_has_no_difficulty() -> None:
    named, file = (manifest(result(run=Run.of(terrain=t))) for t in ("rocky", "a.npy"))
    assert named["arguments"]["difficulty"] == 0.5
    assert "difficulty" not in file["arguments"]
    assert (named["arguments"]["number"], named["arguments"]["world_robot"]) == (0, "")


@pytest.mark.parametrize(
    ("changes", "status", "reason"),
    [
        ({}, "complete", None),
        ({"failure": "left the map"}, "failed", "left the map"),
        ({"interrupted": "SIGINT"}, "interrupted", "SIGINT"),
        ({"topics": {"/scan": TopicCount(4, 3, 1)}}, "failed", "1 messages lost"),
    ],
)
def test_outcome_says_how_the_run_ended(
    changes: dict[str, object], status: str, reason: str | None
) -> None:
    assert manifest(result(**changes))["outcome"] == {"status": status, "reason": reason}


def test_every_figure_of_a_run_stands_in_its_manifest() -> None:
    point = (0.2, 0.1, 0.05)
    event = ContactEvent("hazard", 1_500_000_000, 1_520_000_000, "wheel_FL", "hazard_3", 41.5, point)
    path = ((0.0, 0.0, 0.1), (0.4, 0.0, 0.1))
    truth = Truth(2_000_000_000, 0.8, (1.0, 2.0, 3.0), 4, 5, 6, 0.4, 0.5, 0.6, 0.7, (0.1, 0.2, 0.3, 0.4))
    files = ("cut",), (("a.sdf", "hash"),)
    full = result(
        along=TruthAlong((event,), 7, path, 2.0, 0.002),
        truth=replace(truth, largest_tilt=1.5, tipped_over=True, resets=8),
        info=EpisodeInfo("model", "terrain", 3, (40.0, 30.0), (1.0, 2.0, 0.5), *files),
        command="rover run --seed 3",
        paused_s=9.0,
        waited_s={"/nav": 0.125},
        first_row_s=0.25,
        rows=2,
        log_path=Path("logs/a.csv"),
        thresholds=replace(DEFAULT_THRESHOLDS, collision_threshold=0.125),
        topics={"/scan": TopicCount(40, 39, 1)},
        reception={"/scan": {"received": 40, "rejected": 1, "lost": 0, "remarks": {"empty": 1}}},
        segments=2,
        recording=Path("a.mcap"),
        report=Path("b.html"),
    )
    lasting = [manifest(each) for each in (full, result())]
    for each in lasting:
        del each["versions"]
    check_snapshot("manifests.json", json.dumps(lasting, indent=1) + "\n")


def test_a_manifest_that_cannot_be_written_is_an_error_that_names_it(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"cannot write the summary to .*absent/a\.json: No such file"):
        write_manifest(result(), tmp_path / "absent" / "a.json")
