"""Faults through real DDS: the same rows as without ROS, nothing lost, nothing hangs."""

import csv
import json
from pathlib import Path

import pytest

from harness.run import main

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

SENSORS = (
    ("imu:nan@2+1", "scan:dropout@2+2", "pose:freeze@3+1", "scan:latency=0.2@5", "odometry:huge=0.2@2"),
    (
        *("pose:empty@5+0.5", "scan:empty@1+0.5", "scan:beams=3@3+0.3", "joint_states:empty@3+1"),
        *("imu:duplicate=3", "pose:duplicate@2+3", "scan:spike@4", "imu:stamp-shift=-1@3+1"),
    ),
)
CLOCKS = (
    ("clock:jump=3600@1.5", "clock:jump=-3600@3", "clock:jump=5@4.5", "clock:jump=-2@6.5"),
    ("clock:reset@2.2", "clock:reset@2.7", "clock:jump=-0.05@5.03", "clock:jump=-0.3@6.2"),
    ("clock:freeze@1+1.2", "clock:dropout=0.7@2.5+1", "clock:speed=2.7@4+1.5", "clock:speed=0.3@6"),
)
# Each changes cells of these rows; a tiny number has an exponent on its way through ROS.
PARAMETERS = """
"/**":
  ros__parameters: {collision_threshold: 2.5, distance_threshold: 1.0e-05, gravity: 9.7}
metrics_node:
  ros__parameters: {footprint: [1.0, 0.0, 0.0, 1.0, -1.0, -1.0], near_returns_as_contact: true}
"""


def run(log_dir: Path, *arguments: str) -> Path:
    """Runs the command to its planned end; gives the CSV."""
    light = ["--timestep", "0.005", "--lidar-beams", "90"]
    words = ["--terrain", "rocky", "--duration", "8", *light, "--log-dir", str(log_dir)]
    assert main([*words, *arguments]) == 0
    (log,) = log_dir.glob("*.csv")
    return log


@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("faults", [*SENSORS, *CLOCKS])
def test_faulty_run_writes_the_same_rows_through_ros_as_without_and_loses_nothing(
    faults: tuple[str, ...], tmp_path: Path
) -> None:
    file = tmp_path / "params.yaml"
    file.write_text(PARAMETERS)
    words = [
        "--extended",
        "--params",
        str(file),
        *(word for fault in faults for word in ("--fault", fault)),
    ]
    through_ros = run(tmp_path / "ros", *words)
    direct = run(tmp_path / "direct", *words, "--direct")
    assert through_ros.read_bytes() == direct.read_bytes()
    manifest = json.loads(through_ros.with_suffix(".json").read_text())
    assert manifest["lost"] == 0
    assert (manifest["params"], manifest["thresholds"]["collision_threshold"]) == (str(file), 2.5)
    assert manifest["arguments"]["faults"] == list(faults)


def test_rows_show_the_fault_and_the_drive_does_not(tmp_path: Path) -> None:
    clean = run(tmp_path / "clean", "--direct")
    faulty = run(tmp_path / "faulty", "--direct", "--fault", "scan:stuck=0.1@4+2")
    with clean.open(newline="") as before, faulty.open(newline="") as after:
        calm, struck = list(csv.DictReader(before)), list(csv.DictReader(after))
    assert struck[:3] == calm[:3]
    assert int(struck[-1]["Total Collisions"]) == int(calm[-1]["Total Collisions"]) + 40
    truths = [json.loads(log.with_suffix(".json").read_text())["truth"] for log in (clean, faulty)]
    assert truths[0] == truths[1]


def test_wrong_fault_is_one_line_and_exit_code_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--direct", "--fault", "imu:explode", "--log-dir", str(tmp_path)]) == 2
    told = capsys.readouterr().err
    assert told.startswith("harness.run: fault 'imu:explode': imu has no fault 'explode'; available: ")
    assert told.count("\n") == 1
