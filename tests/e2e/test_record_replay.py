"""Record a run, replay it: the same rows, also from what a killed run left."""

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader
from scipy.spatial.transform import Rotation

from harness.run import main as run
from rover_metrics.replay import main as replay
from tests.support.complaint import complaint
from tests.support.forked_program import ForkedProgram
from tests.support.layouts import foxglove_paths, look_up, plotjuggler_paths
from tests.support.waiting import wait_until

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

Values = NDArray[np.float64]

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


def recorded(bag: Path, *but: str) -> list[tuple[str, int, bytes]]:
    """Topic, time and bytes of every message of the other topics."""
    with AnyReader([bag]) as reader:
        return [(c.topic, t, bytes(data)) for c, t, data in reader.messages() if c.topic not in but]


@pytest.mark.usefixtures("ros_domain")
def test_recorded_run_replays_to_the_same_rows_byte_for_byte_in_every_time(tmp_path: Path) -> None:
    bags = [tmp_path / "one.mcap", tmp_path / "two.mcap"]
    words = ["--terrain", "rocky", "--duration", "6.5", "--log-dir", str(tmp_path / "live")]
    for bag, more in zip(bags, ([], ["--extended"]), strict=True):
        assert run([*words, "--record", str(bag), *more]) == 0
    assert recorded(bags[0], "/rover/metrics") == recorded(bags[1], "/rover/metrics")
    assert len(recorded(bags[0])) - len(recorded(bags[0], "/rover/metrics")) == 6
    logs = sorted((tmp_path / "live").glob("*.csv"), key=size)
    live, extended = (log.read_bytes() for log in logs)
    counts = json.loads(logs[1].with_suffix(".json").read_text())["topics"]
    for topic in ("/odom_ground_truth", "/rover/truth/contact", "/rover/truth/traversal"):
        assert counts[topic]["received"] == counts[topic]["published"] > 120
    assert live.count(b"\n") == 1 + 6
    walk_frames(bags[0])
    walk_layouts(bags[0])
    params = tmp_path / "leo.yaml"
    params.write_text(PARAMETERS)
    plain = tmp_path / "plain.csv"
    assert replay([str(bags[0]), "-o", str(plain)]) == 0
    assert plain.read_bytes() == live
    for source in ("auto", "sim", "recorded", "header"):
        output = tmp_path / f"{source}.csv"
        more = ["--extended", "--params", str(params), "--time", source]
        assert replay([str(bags[0]), "-o", str(output), *more]) == 0
        assert output.read_bytes() == extended


def walk_frames(bag: Path) -> None:
    """Transforms every scan and IMU reading into odom, by no more than what came before it."""
    parents: dict[str, str] = {}
    poses: dict[str, dict[int, tuple[Rotation, Values]]] = {}  # of each child, by stamp
    fixed, told, checked = set(), {"/scan": 0, "/imu/data": 0}, 0
    with AnyReader([bag]) as reader:
        messages: Any = [(c.topic, reader.deserialize(d, c.msgtype)) for c, _, d in reader.messages()]
    truth = {stamp_of(m): m.pose.pose for topic, m in messages if topic == "/odom_ground_truth"}
    for topic, message in messages:
        for one in message.transforms if topic in ("/tf", "/tf_static") else ():
            child, t, r = one.child_frame_id, one.transform.translation, one.transform.rotation
            assert parents.setdefault(child, one.header.frame_id) == one.header.frame_id, "one parent"
            pose = Rotation.from_quat([r.x, r.y, r.z, r.w]), np.array([t.x, t.y, t.z])
            poses.setdefault(child, {})[stamp_of(one)] = pose
            fixed |= {child} if topic == "/tf_static" else set()
        if topic in told:
            told[topic] += 1
            frame, turn, at = message.header.frame_id, Rotation.identity(), np.zeros(3)
            while frame != "odom":
                stamp = 0 if frame in fixed else stamp_of(message)
                rotation, translation = poses[frame][stamp]
                turn, at = rotation * turn, rotation.apply(at) + translation
                frame = parents[frame]
            if topic == "/scan":
                assert np.isfinite(turn.apply(beams(message)) + at).all()
            if topic == "/scan" and stamp_of(message) in truth:
                base = truth[stamp_of(message)]
                yaw = 2 * math.atan2(base.orientation.z, base.orientation.w)
                x, y = base.position.x + 0.174 * math.cos(yaw), base.position.y + 0.174 * math.sin(yaw)
                assert at == pytest.approx((x, y, 0.79783))
                assert turn.as_euler("xyz") == pytest.approx(
                    (0.0, 0.0, math.remainder(yaw + math.pi, math.tau))
                )
                checked += 1
    assert told == {"/scan": 130, "/imu/data": 130}
    assert checked == 65
    roots = {parent for parent in parents.values() if parent not in parents}
    assert roots == {"odom"}, "all frames hang together"


def walk_layouts(bag: Path) -> None:
    """Looks up all that the layouts in examples/ show: numbers, or topics as a whole."""
    with AnyReader([bag]) as reader:
        messages: Any = {c.topic: reader.deserialize(d, c.msgtype) for c, _, d in reader.messages()}
    shown = [look_up(path, messages) for path in (*foxglove_paths(), *plotjuggler_paths())]
    assert sum(isinstance(value, float) for value in shown) >= 20
    assert all(isinstance(value, float) or hasattr(value, "__msgtype__") for value in shown)


def stamp_of(message: Any) -> int:  # noqa: ANN401 - rosbags makes its classes
    """Of a header [ns]."""
    return int(message.header.stamp.sec * 10**9 + message.header.stamp.nanosec)


def beams(scan: Any) -> Values:  # noqa: ANN401 - rosbags makes its classes
    """The points that a scan has hit in its frame, shape (hits, 3)."""
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    hits = np.isfinite(scan.ranges)
    across = np.stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))], axis=1)
    points: Values = scan.ranges[hits, None] * across[hits]
    return points


@pytest.mark.usefixtures("ros_domain")
def test_replay_writes_its_rows_when_the_live_node_did_whatever_the_clock_did(tmp_path: Path) -> None:
    bag, output = tmp_path / "bag.mcap", tmp_path / "replayed.csv"
    light = ["--timestep", "0.005", "--lidar-beams", "8"]
    words = ["--terrain", "flat", "--duration", "12", *light, "--record", str(bag)]
    for fault in ("reset@2.2", "jump=5@4.5", "jump=-0.3@6.2", "freeze@7.5+1.2", "jump=-2@9.9"):
        words += ["--fault", f"clock:{fault}"]
    assert run([*words, "--log-dir", str(tmp_path / "live")]) == 0
    assert replay([str(bag), "-o", str(output)]) == 0
    (log,) = (tmp_path / "live").glob("*.csv")
    assert rows(log) == rows(output)


def size(path: Path) -> int:
    return path.stat().st_size


@pytest.mark.usefixtures("ros_domain")
def test_killed_run_leaves_a_recording_that_replays_to_its_rows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = tmp_path / "killed.mcap"
    words = ["--terrain", "flat", "--duration", "36000", "--lidar-beams", "8", "--record", str(bag)]
    with ForkedProgram("harness.run", [*words, "--log-dir", str(tmp_path / "live")]) as program:
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
def test_remapped_topic_is_recorded_and_replayed_under_its_new_name(tmp_path: Path) -> None:
    bag, output = tmp_path / "bag.mcap", tmp_path / "replayed.csv"
    words = ["--terrain", "flat", "--duration", "2", "--log-dir", str(tmp_path / "live")]
    assert run([*words, "--record", str(bag), "--ros-args", "-r", "scan:=front/scan"]) == 0
    assert replay([str(bag), "-o", str(output), "--remap", "scan:=front/scan"]) == 0
    (log,) = (tmp_path / "live").glob("*.csv")
    assert output.read_bytes() == log.read_bytes()


@pytest.mark.usefixtures("ros_domain")
def test_recording_is_refused_before_the_run_where_it_cannot_be_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--terrain", "flat", "--duration", "1", "--log-dir", str(tmp_path / "live"), "--record")
    taken = tmp_path / "taken.mcap"
    taken.touch()
    assert "taken.mcap exists already, not overwriting" in complaint(run, [*words, str(taken)], capsys)
    nowhere = str(tmp_path / "nowhere" / "x.mcap")
    assert "create it first" in complaint(run, [*words, nowhere], capsys)
    assert "cannot be written: " in complaint(run, [*words, "/proc/x.mcap"], capsys)
    assert "name a file that ends in .mcap" in complaint(run, [*words, "x.bag"], capsys)
    assert "--record needs ROS; leave out --direct" in complaint(
        run, [*words, "x.mcap", "--direct"], capsys
    )
    assert [path.name for path in tmp_path.iterdir()] == ["taken.mcap"]
