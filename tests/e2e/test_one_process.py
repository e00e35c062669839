"""harness.run with a hosted MetricsNode over real DDS, from command line to CSV."""

import csv
import json
from pathlib import Path

import pytest

from harness.robots import ROVERS
from harness.run import main
from rover_metrics.core.columns import Row
from rover_metrics.errors import LogError
from rover_metrics.log.csv_log import CsvLog

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

ROCKY = ["--terrain", "rocky", "--duration", "10"]


def run(log_dir: Path, *arguments: str) -> Path:
    """Runs the command to its planned end; gives the CSV."""
    assert main([*ROCKY, "--log-dir", str(log_dir), *arguments]) == 0
    (log,) = log_dir.glob("*.csv")
    return log


@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("robot", ROVERS)
def test_ten_seconds_on_rocky_give_ten_true_rows_and_lose_nothing(robot: str, tmp_path: Path) -> None:
    log = run(tmp_path / "ros", "--robot", robot)
    with log.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["Timestamp"]) for row in rows] == list(range(1, 11))
    manifest = json.loads(log.with_suffix(".json").read_text())
    distance = float(rows[-1]["Distance Traveled"])
    assert distance == pytest.approx(manifest["truth"]["path_length"], rel=0.05)
    assert distance > 1.0
    heard = {t: c for t, c in manifest["topics"].items() if c["received"] is not None}
    assert set(heard) == {"/scan", "/imu/data", "/rover/pose_array", "/odometry/wheels", "/clock"}
    assert all(c["received"] == c["published"] and c["lost"] == 0 for c in heard.values())
    assert manifest["topics"]["/clock"]["published"] == 1000
    assert manifest["topics"]["/rover/pose_array"]["published"] == 500
    assert manifest["node"]["segments"] == 1
    assert manifest["node"]["topics"]["/scan"]["received"] == 200
    assert len(manifest["truth"]["path"]) == 10

    direct = run(tmp_path / "direct", "--robot", robot, "--direct")
    assert direct.read_bytes() == log.read_bytes()
    assert json.loads(direct.with_suffix(".json").read_text())["truth"] == manifest["truth"]


@pytest.mark.usefixtures("ros_domain")
def test_a_row_that_the_disk_takes_at_the_end_is_no_lost_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, refusals = CsvLog.write, iter([LogError("no space")])

    def write_late(log: CsvLog, row: Row) -> None:
        if log.rows == 1 and (refusal := next(refusals, None)):
            raise refusal
        write(log, row)

    monkeypatch.setattr(CsvLog, "write", write_late)
    assert main(["--terrain", "flat", "--duration", "2", "--log-dir", str(tmp_path)]) == 0
    (log,) = logs(tmp_path)
    assert len(log.read_bytes().splitlines()) == 1 + 2
    assert json.loads(log.with_suffix(".json").read_text())["rows"] == 2


@pytest.mark.usefixtures("ros_domain")
def test_remapped_topics_and_node_parameters_work_the_ros_way(tmp_path: Path) -> None:
    log_dir = tmp_path / "logs"
    words = ["--terrain", "maze", "--duration", "3", "--log-dir", str(log_dir), "--ros-args"]
    assert main([*words, "-r", "scan:=front/scan", "-p", "collision_threshold:=9.0"]) == 0
    (log,) = log_dir.glob("*.csv")
    manifest = json.loads(log.with_suffix(".json").read_text())
    assert manifest["topics"]["/front/scan"] == {"published": 60, "received": 60, "lost": 0}
    assert manifest["last_row"]["Total Collisions"] == 60


@pytest.mark.usefixtures("ros_domain")
def test_extended_columns_know_the_rovers_footprint_and_take_the_users(tmp_path: Path) -> None:
    words = ["--terrain", "maze", "--duration", "1", "--extended", "--log-dir", str(tmp_path)]
    square = [1.0, 1.0, -1.0, 1.0, -1.0, -1.0, 1.0, -1.0]
    clearances = []
    for more in ([], ["--ros-args", "-p", f"footprint:={square}"]):
        assert main([*words, *more]) == 0
        (log,) = tmp_path.glob("*.csv")
        with log.open(newline="") as file:
            (row,) = csv.DictReader(file)
        clearances.append(float(row["Footprint Clearance [m]"]))
        log.unlink()
    leo, larger = clearances
    assert leo - 1.2 < larger < leo - 0.5


def logs(log_dir: Path) -> list[Path]:
    return list(log_dir.glob("*.csv"))
