"""The hosted node: what must stand before a run, and that time waits until it has handled everything."""

import time
from collections import deque
from dataclasses import replace
from itertools import repeat
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from builtin_interfaces.msg import Time
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu as ImuMessage

from harness.base.errors import RunFailed, UsageError
from harness.episode.result import Outputs, TopicCount
from harness.ros import hosted
from harness.ros.hosted import HostedMetrics, heard_by
from harness.ros.network import reserved_domain
from harness.ros.rover_nodes import metrics_node
from harness.run import main
from harness.samples import Imu, Pose, Tick, TruthState
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.extended.settings import ExtendedSettings, Settings
from tests.support.ros import Ros

TICK_NS = 10_000_000
SOON = 1_000  # ticks in which a message of another publisher arrives


class Nodes:
    """A bridge and a hosted MetricsNode in the test's context."""

    def __init__(self, ros: Ros, outputs: Outputs) -> None:
        self.until, self.bridge = ros.until, ros.bridge()
        self.metrics = metrics_node(ros.context, outputs)
        self.hosted = HostedMetrics(self.bridge, self.metrics)
        ros.added(self.metrics)
        self.hosted.await_match()

    def advance(self, tick: Tick, off_ns: int = 0) -> None:
        told = replace(tick, stamp_ns=tick.stamp_ns + off_ns)
        self.bridge.advance(tick, told, listeners=(self.hosted,))


@pytest.fixture
def nodes(ros: Ros, tmp_path: Path) -> Nodes:
    return Nodes(ros, Outputs(log_dir=tmp_path))


def tick(number: int) -> Tick:
    stamp = number * TICK_NS
    pose = Pose(stamp, (0.01 * number, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    imu = Imu(stamp, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 9.8))
    return Tick(stamp, (pose, imu))


def test_every_message_is_handled_before_time_goes_on(nodes: Nodes) -> None:
    for number in range(1, 251):
        nodes.advance(tick(number))
        assert nodes.metrics.received["/rover/pose_array"] == number
        assert nodes.metrics.received["/imu/data"] == number
        assert nodes.metrics.get_clock().now().nanoseconds == number * TICK_NS
        assert nodes.metrics.rows == number // 100
    assert nodes.hosted.received()["/clock"] == 250
    assert set(nodes.hosted.lost.values()) == {0}


def test_nothing_is_given_up_that_came_while_the_process_was_stopped(
    nodes: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hosted, "PATIENCE", 0.0)
    for number in range(1, 6):
        nodes.advance(tick(number))
    assert nodes.hosted.received()["/imu/data"] == 5
    assert set(nodes.hosted.lost.values()) == {0}


def test_simulation_time_cannot_be_taken_from_a_node_that_a_run_waits_for(nodes: Nodes) -> None:
    (told,) = nodes.metrics.set_parameters([Parameter("use_sim_time", value=False)])
    assert (told.successful, "stays true" in told.reason) == (False, True)
    for number in (1, 2):
        nodes.advance(tick(number))
    assert nodes.metrics.get_clock().now().nanoseconds == 2 * TICK_NS


def test_message_that_never_arrives_is_given_up_and_counted(
    nodes: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hosted, "PATIENCE", 0.2)
    nodes.advance(tick(1))
    nodes.bridge.channels_of[Imu][0].published += 3  # three that DDS swallowed
    nodes.advance(tick(2))
    monkeypatch.undo()
    began = time.monotonic()
    nodes.advance(tick(3))
    assert time.monotonic() - began < hosted.PATIENCE, "nothing is waited for twice"
    assert nodes.hosted.lost["/imu/data"] == 3
    assert nodes.hosted.lost["/rover/pose_array"] == 0
    assert nodes.hosted.received()["/imu/data"] == 3


def test_truth_for_the_extended_columns_is_waited_for_and_missed_as_every_topic(
    ros: Ros, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hosted, "PATIENCE", 0.2)
    nodes = Nodes(ros, Outputs(log_dir=tmp_path, settings=Settings(extended_columns=True)))
    state = TruthState(TICK_NS, True, False, False, 5.0, 0.3, 1.0, (0.1, 0.1, 0.1, 0.1), 0.01)
    nodes.advance(Tick(TICK_NS, (state,)))
    contact, traversal = nodes.bridge.channels_of[TruthState]
    assert (nodes.hosted.received()[contact.topic], nodes.hosted.received()[traversal.topic]) == (1, 1)
    contact.published += 1  # one that DDS swallowed
    nodes.hosted.wait_for_samples([contact])
    assert nodes.hosted.lost[contact.topic] == 1


def test_a_clock_that_never_arrives_is_given_up_and_counted(
    nodes: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hosted, "PATIENCE", 0.1)
    nodes.bridge.clock_channel.published += 1  # one that DDS swallowed
    nodes.hosted.wait_for_clock(7 * TICK_NS)
    assert nodes.hosted.lost["/clock"] == 1
    assert nodes.hosted.received()["/clock"] == 0


@pytest.mark.parametrize("off_ns", [0, 3])  # as of a clock with a fault, which tells no whole seconds
def test_second_publisher_of_a_topic_fails_the_run(nodes: Nodes, off_ns: int) -> None:
    nodes.advance(tick(1))
    intruder = nodes.metrics.create_publisher(ImuMessage, "imu/data", 10)
    nodes.until(lambda: intruder.get_subscription_count() > 0)
    intruder.publish(ImuMessage())
    with pytest.raises(RunFailed, match=r"/imu/data has a second publisher.*ROS_DOMAIN_ID"):
        deque(map(nodes.advance, map(tick, range(2, SOON)), repeat(off_ns)), 0)


@pytest.mark.parametrize("strange_ns", [99 * 10**9, TICK_NS])
def test_second_clock_fails_the_run_also_where_it_tells_a_time_of_ours(
    nodes: Nodes, strange_ns: int
) -> None:
    for number in (1, 2):
        nodes.advance(tick(number))
    intruder = nodes.metrics.create_publisher(Clock, "/clock", 10)
    nodes.until(lambda: intruder.get_subscription_count() > 0)
    sec, nanosec = divmod(strange_ns, 10**9)
    intruder.publish(Clock(clock=Time(sec=sec, nanosec=nanosec)))
    with pytest.raises(RunFailed, match=r"/clock has a second publisher"):
        deque(map(nodes.hosted.wait_for_clock, range(3 * TICK_NS, SOON * TICK_NS, TICK_NS)), 0)
    assert nodes.metrics.get_clock().now().nanoseconds == strange_ns


def test_a_node_that_dds_does_not_connect_is_refused_with_its_topics(
    ros: Ros, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hosted, "DISCOVERY_PATIENCE", 0.1)
    context, bridge = rclpy.Context(), ros.bridge()
    with reserved_domain() as elsewhere:
        rclpy.init(context=context, domain_id=elsewhere)
        away = metrics_node(context, Outputs(log_dir=tmp_path))
        with pytest.raises(UsageError, match=r"DDS did not connect /scan, .*, /clock within"):
            HostedMetrics(bridge, away).await_match()
        away.destroy_node()
        context.shutdown()


def test_settings_reach_the_hosted_node_as_a_value_and_the_command_line_wins(
    ros_domain: int, tmp_path: Path
) -> None:
    context = rclpy.Context()
    words = ["--ros-args", "-p", "collision_threshold:=0.3", "-p", "log_dir:=/elsewhere"]
    rclpy.init(args=words, context=context, domain_id=ros_domain)
    given = Settings(
        log_dir="/nowhere",
        extended_columns=True,
        thresholds=Thresholds(collision_threshold=0.7, distance_threshold=0.8),
        extended=ExtendedSettings(wheels="left,right"),
    )
    node = metrics_node(context, Outputs(log_dir=tmp_path, settings=given), "leo")
    thresholds = Thresholds(collision_threshold=0.3, distance_threshold=0.8)
    assert node.settings == replace(given, log_dir=str(tmp_path), thresholds=thresholds)
    assert node.get_parameter("use_sim_time").value is True
    assert node.log.path.parent == tmp_path
    assert "True Slip Left" in node.log.path.read_text()
    assert "/leo/rover/truth/contact" in node.received
    node.destroy_node()
    (tmp_path / "file").touch()
    with pytest.raises(UsageError, match="file"):
        metrics_node(context, Outputs(log_dir=tmp_path / "file" / "logs"))
    context.shutdown()


def test_what_any_rovers_node_lost_of_a_shared_topic_is_lost() -> None:
    clock, scan = {"/clock": 7}, {"/clock": 10, "/a/scan": 4}
    hosts: Any = [
        SimpleNamespace(received=lambda: clock, lost={"/clock": 3}),
        SimpleNamespace(received=lambda: scan, lost=dict.fromkeys(scan, 0)),
    ]
    heard = heard_by(hosts, {topic: TopicCount(10) for topic in ("/clock", "/a/scan", "/a/tf")})
    counts = {topic: (count.received, count.lost) for topic, count in heard.items()}
    assert counts == {"/clock": (10, 3), "/a/scan": (4, 0), "/a/tf": (None, 0)}


@pytest.mark.usefixtures("ros_domain")
def test_a_run_that_is_refused_leaves_no_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("harness.ros.remote.DISCOVERY_PATIENCE", 0.1)
    assert main(["--terrain", "flat", "--wait-for", "/nobody", "--log-dir", str(tmp_path)]) == 2
    assert list(tmp_path.iterdir()) == []
