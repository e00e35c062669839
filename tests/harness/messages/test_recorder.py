"""The recorder on a bridge of its own: what is in the file, and when it is there."""

import errno
import os
import re
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import Twist, Vector3
from mcap.exceptions import EndOfFile
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader
from mcap.writer import Writer
from rclpy.serialization import serialize_message
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState, LaserScan

from harness import __version__, samples
from harness.base.errors import RunFailed, UsageError
from harness.messages.cdr import padding_of
from harness.messages.recorder import Recorder, full_definition
from harness.robots import find_rover
from harness.robots.frames.tree import Description
from harness.ros.bridge import Bridge
from harness.ros.tap import Tap
from rover_metrics.health.live_view import Level, Status
from rover_metrics.ros.metrics_publisher import MetricsPublisher
from tests.support.ros import Ros

BEAMS = 4
STEP_NS = 50_000_000
TOPICS = {
    "/tf": "tf2_msgs/msg/TFMessage",
    "/scan": "sensor_msgs/msg/LaserScan",
    "/imu/data": "sensor_msgs/msg/Imu",
    "/rover/pose_array": "geometry_msgs/msg/PoseArray",
    "/odometry/wheels": "nav_msgs/msg/Odometry",
    "/odom_ground_truth": "nav_msgs/msg/Odometry",
    "/joint_states": "sensor_msgs/msg/JointState",
    "/rover/truth/contact": "std_msgs/msg/Bool",
    "/rover/truth/traversal": "std_msgs/msg/Float64MultiArray",
    "/clock": "rosgraph_msgs/msg/Clock",
}
LATCHED = {"/tf_static": "tf2_msgs/msg/TFMessage", "/robot_description": "std_msgs/msg/String"}
HEARD = {"/cmd_vel": "geometry_msgs/msg/Twist"}


@pytest.fixture
def bridge(ros: Ros) -> Bridge:
    made: Bridge = ros.bridge()
    return made


def publish(bridge: Bridge, ticks: int) -> None:
    """Ticks of 50 ms with one sample of every kind."""
    joints = (0.0,) * len(find_rover("leo").joints)
    for number in range(1, 1 + ticks):
        t = number * STEP_NS
        level = (0.0, 0.0, 0.0, 1.0)
        tick = samples.Tick(
            t,
            (
                samples.Transforms(t, (float(number), 0.0, 0.0), level),
                samples.LaserScan(t, np.full(BEAMS, number, dtype=np.float32)),
                samples.Imu(t, level, (0.0, 0.0, 0.1), (0.0, 0.0, 9.8)),
                samples.Pose(t, (float(number), 0.0, 0.0), level, empty=number % 5 == 0),
                samples.Odometry(t, 0.0, 0.0, 0.1, samples.Twist(0.5, 0.1)),
                samples.GroundTruth(t, 0.0, 0.0, 0.1, (0.5, 0.0, 0.0), (0.0, 0.0, 0.1)),
                samples.JointStates(t, joints, joints, joints),
                samples.TruthState(t, True, False, True, 12.5, 0.5, 0.1, (0.1, 0.2, -0.1, 0.0), 0.003),
            ),
        )
        bridge.advance(tick, tick, listeners=())


def record(path: Path, bridge: Bridge, ticks: int) -> None:
    with Recorder(path) as recorder:
        Tap(recorder).tap(bridge)
        publish(bridge, ticks)


def test_the_file_is_one_that_rosbag2_and_rosbags_read_without_another(
    bridge: Bridge, tmp_path: Path
) -> None:
    record(tmp_path / "bag.mcap", bridge, 2)
    with (tmp_path / "bag.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        header, summary = reader.get_header(), reader.get_summary()
        (metadata,) = reader.iter_metadata()
    assert summary is not None
    assert (header.profile, header.library) == ("ros2", f"rover-harness {__version__}")
    assert (metadata.name, list(metadata.metadata)) == ("rosbag2", ["serialized_metadata"])
    assert "version: 8\nstorage_identifier: mcap\n" in metadata.metadata["serialized_metadata"]
    assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
    store = get_typestore(Stores.LATEST)
    for channel in summary.channels.values():
        assert channel.message_encoding == "cdr"
        kind = (TOPICS | HEARD | LATCHED)[channel.topic]
        assert summary.schemas[channel.schema_id].name == kind
        assert channel.metadata["topic_type_hash"] == store.hash_rihs01(kind)
    with AnyReader([tmp_path / "bag.mcap"]) as bag:
        assert bag.message_count == 2 * len(TOPICS)
        messages = {c.topic: bag.deserialize(data, c.msgtype) for c, _, data in bag.messages()}
    assert messages["/scan"].ranges.tolist() == [2.0] * BEAMS  # type: ignore[attr-defined]


def test_of_the_last_seconds_what_is_latched_stays(bridge: Bridge, tmp_path: Path) -> None:
    def recorded(name: str, last: float | None, *, kept: bool = True) -> list[tuple[str, int, bytes]]:
        bridge.time_ns = 0
        with Recorder(tmp_path / name, last=last) as recorder:
            Tap(recorder).tap(bridge)
            for urdf in ("<old/>", "<robot/>"):
                bridge.describe(Description((), (), owns_odom=False, urdf=urdf))
            publish(bridge, 6)
            bridge.stop_recording()
            if not kept:
                recorder.forget()
        if not kept:
            return []
        with AnyReader([tmp_path / name]) as bag:
            return [(each.topic, time, bytes(data)) for each, time, data in bag.messages()]

    first_ns = 4 * STEP_NS
    every = recorded("whole.mcap", None)
    latest = {topic: data for topic, _, data in every if topic in LATCHED}
    fixed = [(topic, first_ns, data) for topic, data in latest.items()]
    recent = [one for one in every if one[1] >= first_ns]
    assert len(fixed) == 2
    assert len(recent) == 3 * len(TOPICS)
    assert sorted(recorded("last.mcap", 0.1)) == sorted(fixed + recent)
    assert sorted(recorded("all.mcap", 9.0)) == sorted(every)
    recorded("none.mcap", 0.1, kept=False)
    assert not (tmp_path / "none.mcap").exists()


def test_definition_holds_every_nested_type_once() -> None:
    nested = re.findall(r"^MSG: (.*)$", full_definition("nav_msgs/msg/Odometry"), re.MULTILINE)
    assert nested == sorted(set(nested))
    assert {"builtin_interfaces/Time", "std_msgs/Header", "geometry_msgs/Vector3"} < set(nested)


def test_padding_is_what_aligns_the_fields() -> None:
    scan = LaserScan()
    scan.header.frame_id = "ab"
    end = 4 + 8 + 4 + 2  # header, stamp, length, text; then the string's zero, always written as such
    assert padding_of(serialize_message(scan), TOPICS["/scan"]) == [end, end + 1]
    nothing = serialize_message(JointState())  # of joints that a fault has emptied
    fields = 4 + 8 + 4 + 4 + 4 * 4  # encapsulation, stamp, frame with its end, four counts
    assert set(range(fields, len(nothing))) <= set(padding_of(nothing, "sensor_msgs/msg/JointState"))


def test_all_but_the_last_second_is_on_disk_while_recording(bridge: Bridge, tmp_path: Path) -> None:
    path = tmp_path / "bag.mcap"
    with Recorder(path) as recorder:
        Tap(recorder).tap(bridge)
        publish(bridge, 60)
        copy = tmp_path / "killed.mcap"
        copy.write_bytes(path.read_bytes())
    stamps: list[int] = []
    with copy.open("rb") as file, pytest.raises(EndOfFile):
        stamps.extend(e.log_time for e in StreamReader(file).records if isinstance(e, Message))
    assert stamps == [n * STEP_NS for n in range(1, 60) for _ in TOPICS]


@pytest.mark.parametrize(
    ("name", "overwrite", "mend"),
    [
        ("there.mcap", False, "exists already, not overwriting"),
        ("bag.db3", True, "name a file that ends in .mcap"),
        ("folder.mcap", True, "is a folder; name a file"),
        ("pipe.mcap", True, "is a device or a pipe; name a file"),
    ],
)
def test_an_impossible_file_is_refused(name: str, overwrite: bool, mend: str, tmp_path: Path) -> None:
    (tmp_path / "there.mcap").write_text("precious")
    (tmp_path / "folder.mcap").mkdir()
    os.mkfifo(tmp_path / "pipe.mcap")
    with pytest.raises(UsageError, match=mend):
        Recorder(tmp_path / name, overwrite=overwrite)
    assert (tmp_path / "there.mcap").read_text() == "precious"


@pytest.mark.parametrize("is_link", [False, True])
def test_existing_file_is_replaced_on_request_once_there_is_a_message(
    bridge: Bridge, tmp_path: Path, *, is_link: bool
) -> None:
    path, outside = tmp_path / "bag.mcap", tmp_path / "outside"
    outside.write_text("precious")
    if is_link:
        path.symlink_to(outside)
    else:
        path.write_text("precious")
    with pytest.raises(UsageError), Recorder(path, overwrite=True):
        raise UsageError
    assert path.read_text() == "precious"
    with Recorder(path, overwrite=True) as recorder:
        Tap(recorder).tap(bridge)
        assert path.read_text() == "precious"
        publish(bridge, 1)
        assert path.read_bytes().startswith(b"\x89MCAP")
    assert {each.name for each in tmp_path.iterdir()} == {"bag.mcap", "outside"}
    assert outside.read_text() == "precious"
    with AnyReader([path]) as bag:
        assert bag.message_count == len(TOPICS)


def test_commands_and_the_nodes_metrics_are_recorded_at_the_time_of_the_tick(
    bridge: Bridge, tmp_path: Path
) -> None:
    told: list[str] = []
    metrics = MetricsPublisher(bridge, told.append, enabled=True)
    # As long as each other, with their padding elsewhere.
    names = (("a", "abcde"), ("abcde", "a"))
    with Recorder(tmp_path / "bag.mcap") as recorder:
        Tap(recorder).tap(bridge, metrics)
        publish(bridge, 1)
        for name, message in names:
            status = Status(Level.WARN, name, message, (("key", "1.5"),))
            metrics.publish(0, lambda status=status: [status])  # type: ignore[misc]
        bridge.commands.receive("twist", Twist(linear=Vector3(x=0.25)))
        bridge.stop_recording()
        bridge.commands.receive("twist", Twist())
        publish(bridge, 1)
    assert told == []
    store = get_typestore(Stores.LATEST)
    with AnyReader([tmp_path / "bag.mcap"]) as bag:
        everything = [(c.topic, t, c.msgtype, d) for c, t, d in bag.messages()]
    found = [each for each in everything if each[0] not in TOPICS]
    assert len(everything) == len(found) + len(TOPICS)  # nothing from behind `stop_recording`
    assert [(topic, time_ns) for topic, time_ns, _, _ in found] == [
        ("/rover/metrics", STEP_NS),
        ("/rover/metrics", STEP_NS),
        ("/cmd_vel", STEP_NS),
    ]
    first, second, command = (store.deserialize_cdr(data, kind) for _, _, kind, data in found)
    assert [(m.status[0].name, m.status[0].message) for m in (first, second)] == [  # type: ignore[attr-defined]
        (f"harness: {name}", message) for name, message in names
    ]
    assert command.linear.x == 0.25  # type: ignore[attr-defined]
    for one, (_, _, kind, data) in zip((first, second, command), found, strict=True):
        assert bytes(store.serialize_cdr(one, kind)) == data  # what aligns is zero


def test_a_recording_does_not_depend_on_the_order_in_which_nodes_publish_their_metrics(
    ros: Ros, tmp_path: Path
) -> None:
    fleet = [ros.bridge(namespace=name) for name in ("a", "b")]
    nodes = [MetricsPublisher(bridge, print, enabled=True) for bridge in fleet]
    for name, last in (("whole", None), ("last", 9.0)):
        files = [tmp_path / f"{name}{number}.mcap" for number in (0, 1)]
        for file, order in zip(files, (nodes, nodes[::-1]), strict=True):
            with Recorder(file, last=last) as recorder:
                tap = Tap(recorder)
                for bridge, metrics in zip(fleet, nodes, strict=True):
                    tap.tap(bridge, metrics)
                for time_ns in (10, 20, 30):
                    fleet[0].time_ns = time_ns
                    for node in order:
                        node.publish(time_ns, lambda: [Status(Level.OK, "a", "b", ())])
                    if time_ns == 20:
                        fleet[0].commands.receive("twist", Twist())
        assert files[0].read_bytes() == files[1].read_bytes()
        with AnyReader([files[0]]) as bag:
            assert bag.message_count == 3 * len(nodes) + 1


@pytest.mark.parametrize("is_full_at_once", [True, False])
def test_a_full_disk_ends_the_run_with_the_reason_once(
    bridge: Bridge, is_full_at_once: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    reason = r"bag\.mcap ended early: No space left on device"
    monkeypatch.setattr(Writer, "finish", full)
    if not is_full_at_once:
        with pytest.raises(RunFailed, match=reason):
            record(tmp_path / "bag.mcap", bridge, 1)
        with pytest.raises(RunFailed, match="ended early"), Recorder(tmp_path / "none.mcap"):
            pass
        assert not (tmp_path / "none.mcap").exists()
        return
    monkeypatch.setattr(Writer, "add_message", full)
    with Recorder(tmp_path / "bag.mcap") as recorder:
        Tap(recorder).tap(bridge)
        with pytest.raises(RunFailed, match=reason):
            publish(bridge, 1)
