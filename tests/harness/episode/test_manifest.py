import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.episode.batch import EpisodeInfo
from harness.episode.manifest import manifest, write_manifest
from harness.episode.result import RunResult, TopicCount
from harness.episode.truth_account import TruthAlong
from harness.spec.run import Run
from harness.truth.traversal import ContactEvent, Truth
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS
from rover_metrics.log.session_record import session_thresholds


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


def test_the_nodes_own_account_and_other_files_are_named() -> None:
    account = {"/scan": {"received": 40, "rejected": 1, "lost": 0, "remarks": {"empty": 1}}}
    told = manifest(
        result(reception=account, segments=2, recording=Path("a.mcap"), report=Path("b.html"))
    )
    assert told["node"] == {"segments": 2, "topics": account}
    assert (told["recording"], told["report"]) == ("a.mcap", "b.html")
    assert manifest(result())["node"] is None


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
    truth = Truth(2_000_000_000, 0.8, (1.0, 2.0, 3.0), 4, 5, 6, 0.4, 0.5, 0.6, 0.7, (0.1, 0.2, 0.3, 0.4))
    told = manifest(
        result(
            along=TruthAlong(
                events=(event,),
                event_count=7,
                path=((0.0, 0.0, 0.1), (0.4, 0.0, 0.1)),
                path_period_s=2.0,
                roughness_p50=0.002,
            ),
            truth=replace(truth, largest_tilt=1.5, tipped_over=True, resets=8),
            info=EpisodeInfo(
                "model", "terrain", 3, (40.0, 30.0), (1.0, 2.0, 0.5), ("cut",), (("a.sdf", "hash"),)
            ),
            paused_s=9.0,
            waited_s={"/nav": 0.125},
            first_row_s=0.25,
            rows=2,
            log_path=Path("logs/a.csv"),
            thresholds=replace(DEFAULT_THRESHOLDS, collision_threshold=0.125),
            topics={"/scan": TopicCount(40, 39, 1)},
        )
    )
    assert told["simulated_s"] == 2.0
    assert (told["wall_s"], told["paused_s"], told["first_row_s"]) == (0.5, 9.0, 0.25)
    assert told["waited_s"] == {"/nav": 0.125}
    assert (told["rows"], told["log"], told["lost"], told["mode"]) == (2, "logs/a.csv", 1, "direct")
    assert told["topics"] == {"/scan": {"published": 40, "received": 39, "lost": 1}}
    assert told["thresholds"]["collision_threshold"] == 0.125
    assert told["world"] == {
        "model_hash": "model",
        "terrain_hash": "terrain",
        "obstacles": 3,
        "map_size": [40.0, 30.0],
        "start": [1.0, 2.0, 0.5],
        "notes": ["cut"],
        "files": [["a.sdf", "hash"]],
    }
    expected = {
        "time_s": 2.0,
        "path_length": 0.8,
        "position": [1.0, 2.0, 3.0],
        "mean_speed": 0.4,
        "hazard_contacts": 4,
        "rock_contacts": 5,
        "scrapes": 6,
        "resets": 8,
        "hazard_contact_s": 0.4,
        "rock_contact_s": 0.5,
        "scrape_s": 0.6,
        "mean_slip": 0.7,
        "wheel_slip": [0.1, 0.2, 0.3, 0.4],
        "largest_tilt": 1.5,
        "tipped_over": True,
        "event_count": 7,
        "events": [
            {
                "kind": "hazard",
                "start_s": 1.5,
                "end_s": 1.52,
                "part": "wheel_FL",
                "other": "hazard_3",
                "force_n": 41.5,
                "point": [0.2, 0.1, 0.05],
            }
        ],
        "path": [[0.0, 0.0, 0.1], [0.4, 0.0, 0.1]],
        "path_period_s": 2.0,
        "roughness": {"p50": 0.002, "p95": None},
    }
    assert told["truth"] == expected
    assert manifest(result(truth=replace(truth, path_length=math.inf)))["truth"]["path_length"] is None
    empty = manifest(result())
    assert [empty[name] for name in ("world", "log", "recording", "report")] == [None] * 4


def test_a_manifest_that_cannot_be_written_is_an_error_that_names_it(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"cannot write the summary to .*absent/a\.json: No such file"):
        write_manifest(result(), tmp_path / "absent" / "a.json")
