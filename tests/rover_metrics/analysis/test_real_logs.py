"""RoboTerrain's own logs give the numbers that were worked out from them by other means."""

import json
from pathlib import Path

import pytest

from rover_metrics.analyze import main

LOGS = Path(__file__).parents[4] / "shared/data/roboterrain/logs"
SINCE_START = (
    "Current Smoothness is the mean since the start, as RoboTerrain's node writes it since 2025 (its "
    "buffer is never trimmed), not of the last 100 samples"
)
WALL = "wall-clock timestamps: of a real robot, or the node ran without use_sim_time"

# rows, seconds, collisions/min, m/min, % rough, from facts about the logs
KNOWN = {
    "1": (97, 99, 0.0, 13.0, 5.2),
    "metrics_log_20241117_120944": (68, 67, 430.0, 0.76, 11.8),
    "metrics_log_20250116_120457": (601, 600, 2.2, 19.2, 19.6),
    "metrics_log_20250116_125842": (682, 681, 4.6, 28.8, 20.5),
}
ODD = {
    "1": (
        "spaces before numbers",
        SINCE_START,
        "3 short gaps (first on line 57): up to 2 s, rates are over the time that passed",
        WALL,
    ),
    "metrics_log_20241117_120944": ("11 columns, without Vertical Roughness: no VR", WALL),
    "metrics_log_20250116_120457": (SINCE_START, WALL),
    "metrics_log_20250116_125842": (SINCE_START, WALL),
}


@pytest.mark.skipif(not LOGS.is_dir(), reason="needs the RoboTerrain logs in ../shared/data")
def test_the_real_logs_give_what_is_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["-m", "TC", "DT", "RT", "VR", "-p", "--json", "-o"]
    assert main([*map(str, sorted(LOGS.glob("*.csv"))), *words, str(tmp_path)]) == 0
    result = json.loads(capsys.readouterr().out)
    found = {log["label"]: log for log in result["logs"]}
    assert set(found) == set(KNOWN)
    for label, (rows, seconds, collisions, metres, rough) in KNOWN.items():
        log = found[label]
        assert (log["rows"], log["duration"], log["episodes"]) == (rows, seconds, 1)
        means = [log["metrics"][code]["mean"] for code in ("TC", "DT", "RT")]
        assert means == pytest.approx([collisions, metres, rough], rel=0.02)
        assert tuple(log["findings"]) == ODD[label]
    assert "VR" not in found["metrics_log_20241117_120944"]["metrics"]
    assert result["across"]["all logs"]["VR"]["n"] == 3
