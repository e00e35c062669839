"""Record a run, replay it: the same rows, also from what a killed run left."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest
from rosbags.highlevel import AnyReader

from harness.run import main as run
from rover_metrics.replay import main as replay
from tests.support.forked_program import ForkedProgram
from tests.support.layouts import foxglove_paths, look_up, plotjuggler_paths
from tests.support.waiting import wait_until

PARAMETERS = """
metrics_node:
  ros__parameters:
    footprint: [-0.212, -0.214, 0.218, -0.214, 0.218, 0.214, -0.212, 0.214]
    lidar_pose: [0.174, 0.0, 3.141592653589793]
    gravity: 9.8
"""


def rows(log: Path) -> list[list[str]]:
    with log.open(newline="") as file:
        return list(csv.reader(file))


def test_recorded_run_replays_to_the_same_rows_byte_for_byte_in_every_time(tmp_path: Path) -> None:
    bag, params = tmp_path / "run.mcap", tmp_path / "leo.yaml"
    words = ["--direct", "--terrain", "rocky", "--duration", "6.5", "--log-dir", str(tmp_path / "live")]
    assert run([*words, "--record", str(bag), "--extended"]) == 0
    (live,) = tmp_path.glob("live/*.csv")
    walk_layouts(bag)
    params.write_text(PARAMETERS)
    for source in ("auto", "sim", "recorded", "header"):
        output = tmp_path / f"{source}.csv"
        more = ["--extended", "--params", str(params), "--time", source]
        assert replay([str(bag), "-o", str(output), *more]) == 0
        assert output.read_bytes() == live.read_bytes()


def walk_layouts(bag: Path) -> None:
    """Looks up all that the layouts in examples/ show: numbers, or topics as a whole."""
    with AnyReader([bag]) as reader:
        messages: Any = {c.topic: reader.deserialize(d, c.msgtype) for c, _, d in reader.messages()}
    shown = [look_up(path, messages) for path in (*foxglove_paths(), *plotjuggler_paths())]
    assert sum(isinstance(value, float) for value in shown) >= 20
    assert all(isinstance(value, float) or hasattr(value, "__msgtype__") for value in shown)


def test_killed_run_leaves_a_recording_that_replays_to_its_rows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = tmp_path / "killed.mcap"
    words = ["--terrain", "flat", "--duration", "36000", "--lidar-beams", "8", "--record", str(bag)]
    with ForkedProgram(
        "harness.run", ["--direct", *words, "--log-dir", str(tmp_path / "live")]
    ) as program:
        wait_until(lambda: program.poll() is not None or lines(tmp_path / "live") > 6)
        assert program.poll() is None, "the run ended"
    (log,) = (tmp_path / "live").glob("*.csv")
    live = rows(log)
    output = tmp_path / "replayed.csv"
    assert replay([str(bag), "-o", str(output)]) == 1
    assert "killed.mcap has no end, as when a recording is killed" in capsys.readouterr().err
    replayed = rows(output)
    assert replayed == live[: len(replayed)]
    assert len(replayed) >= len(live) - 2


def lines(folder: Path) -> int:
    return sum(log.read_bytes().count(b"\n") for log in folder.glob("*.csv"))


@pytest.mark.usefixtures("ros_domain")
def test_remapped_topics_and_node_parameters_work_the_ros_way_and_replay(tmp_path: Path) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    bag, output = tmp_path / "bag.mcap", tmp_path / "replayed.csv"
    words = ["--terrain", "maze", "--duration", "3", "--log-dir", str(tmp_path / "live")]
    ros = ["--ros-args", "-r", "scan:=front/scan", "-p", "collision_threshold:=9.0"]
    assert run([*words, "--record", str(bag), *ros]) == 0
    (log,) = (tmp_path / "live").glob("*.csv")
    manifest = json.loads(log.with_suffix(".json").read_text())
    assert manifest["topics"]["/front/scan"] == {"published": 60, "received": 60, "lost": 0}
    assert manifest["last_row"]["Total Collisions"] == 60
    params = tmp_path / "p.yaml"
    params.write_text("metrics_node:\n  ros__parameters: {collision_threshold: 9.0}\n")
    more = ["--remap", "scan:=front/scan", "--params", str(params)]
    assert replay([str(bag), "-o", str(output), *more]) == 0
    assert output.read_bytes() == log.read_bytes()
