import json
import math
from pathlib import Path

import pytest

from harness.config import EpisodeConfig
from harness.errors import UsageError
from harness.manifest import check_writable, manifest, write_manifest
from harness.result import RunResult, TopicCount
from harness.truth import Truth


def result(**changes: object) -> RunResult:
    values: dict[str, object] = {
        "config": EpisodeConfig(seed=7),
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
    assert [path.name for path in tmp_path.iterdir()] == ["run.json"]


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


def test_unwritable_summary_is_refused_with_the_mend(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="is a folder; name a file"):
        check_writable(tmp_path)
    with pytest.raises(UsageError, match=r"there is no folder .*; create it first"):
        check_writable(tmp_path / "absent" / "run.json")
    check_writable(tmp_path / "run.json")
