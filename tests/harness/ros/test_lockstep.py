from collections.abc import Iterator
from pathlib import Path

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from builtin_interfaces.msg import Time
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu as ImuMessage

from harness.errors import RunFailed
from harness.ros import lockstep
from harness.ros.bridge import Bridge
from harness.ros.executor import make_executor, spin_until
from harness.ros.lockstep import HostedMetrics, LockStep
from harness.samples import Imu, Pose, Tick, TruthState
from harness.sensors.lidar_spec import LidarSpec
from rover_metrics.metrics_node import MetricsNode
from tests.support.rovers import LEO

TICK_NS = 10_000_000


class Nodes:
    """A bridge and a hosted MetricsNode in a context of their own."""

    def __init__(self, log_dir: Path, **parameters: object) -> None:
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.bridge = Bridge(LEO, LidarSpec(beams=4), context=self.context)
        values = {"use_sim_time": True, "log_dir": str(log_dir), **parameters}
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        self.metrics = MetricsNode(context=self.context, parameter_overrides=overrides)
        self.executor = make_executor(self.context)
        self.executor.add_node(self.bridge)
        self.executor.add_node(self.metrics)
        self.hosted = HostedMetrics(self.bridge, self.executor, self.metrics)
        channels = [c for c in self.bridge.channels if c.topic in self.hosted.topics]
        self.until(
            lambda: all(
                c.publisher.get_subscription_count() for c in (*channels, self.bridge.clock_channel)
            )
        )

    def until(self, condition: object) -> None:
        assert spin_until(self.executor, condition, 10.0)  # type: ignore[arg-type]

    def close(self) -> None:
        self.executor.shutdown()
        self.metrics.destroy_node()
        self.bridge.destroy_node()
        self.context.try_shutdown()


@pytest.fixture
def nodes(ros_domain: int, tmp_path: Path) -> Iterator[Nodes]:  # noqa: ARG001 - sets the domain
    made = Nodes(tmp_path)
    yield made
    made.close()


def tick(number: int) -> Tick:
    stamp = number * TICK_NS
    pose = Pose(stamp, (0.01 * number, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    imu = Imu(stamp, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 9.8))
    return Tick(stamp, (pose, imu))


def test_every_message_is_handled_before_time_goes_on(nodes: Nodes) -> None:
    step = LockStep(nodes.bridge, nodes.executor, (nodes.hosted,))
    for number in range(1, 251):
        step.advance(tick(number))
        assert nodes.metrics.received["/rover/pose_array"] == number
        assert nodes.metrics.received["/imu/data"] == number
        assert nodes.metrics.get_clock().now().nanoseconds == number * TICK_NS
        assert nodes.metrics.rows == number // 100
    assert nodes.hosted.received()["/clock"] == 250
    assert set(nodes.hosted.lost.values()) == {0}


def test_message_that_never_arrives_is_given_up_and_counted(
    nodes: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lockstep, "PATIENCE", 0.2)
    step = LockStep(nodes.bridge, nodes.executor, (nodes.hosted,))
    step.advance(tick(1))
    nodes.bridge.channels_of[Imu][0].published += 3  # three that DDS swallowed
    step.advance(tick(2))
    monkeypatch.undo()
    monkeypatch.delattr(HostedMetrics, "_give_up")  # nothing is waited for twice
    step.advance(tick(3))
    assert nodes.hosted.lost["/imu/data"] == 3
    assert nodes.hosted.lost["/rover/pose_array"] == 0
    assert nodes.hosted.received()["/imu/data"] == 3


def test_truth_for_the_extended_columns_is_waited_for_and_missed_as_every_topic(
    ros_domain: int,  # noqa: ARG001 - sets the domain
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(lockstep, "PATIENCE", 0.2)
    nodes = Nodes(tmp_path, extended_columns=True)
    step = LockStep(nodes.bridge, nodes.executor, (nodes.hosted,))
    state = TruthState(TICK_NS, True, False, False, 5.0, 0.3, 1.0, (0.1, 0.1, 0.1, 0.1), 0.01)
    step.advance(Tick(TICK_NS, (state,)))
    contact, traversal = nodes.bridge.channels_of[TruthState]
    assert (nodes.hosted.received()[contact.topic], nodes.hosted.received()[traversal.topic]) == (1, 1)
    contact.published += 1  # one that DDS swallowed
    step.advance(tick(2))
    assert nodes.hosted.lost[contact.topic] == 1
    nodes.close()


class Noted:
    """A bridge, an executor and a listener that only say what is asked of them."""

    def __init__(self) -> None:
        self.said: list[object] = []

    def publish_samples(self, tick: Tick) -> None:
        self.said.append(tick.samples)

    def publish_clock(self, tick: Tick) -> None:
        self.said.append(tick.stamp_ns)

    def wait_for_samples(self) -> None:
        self.said.append("samples")

    def wait_for_clock(self, stamp_ns: int) -> None:
        self.said.append(("clock", stamp_ns))

    def spin_once(self, timeout_sec: float) -> None:
        self.said.append(("spin", timeout_sec))


@pytest.mark.parametrize("tells_time", [True, False])
def test_samples_of_one_kind_go_out_one_by_one_then_the_clock_if_it_tells_time(tells_time: bool) -> None:
    pose, imu = tick(1).samples
    noted = Noted()
    sent = Tick(5, (pose, pose, imu, pose), tells_time)
    LockStep(noted, noted, (noted, noted)).advance(sent)  # type: ignore[arg-type]
    waits = ["samples", "samples"]
    bursts = [(pose, imu), *waits, (pose,), *waits, (pose,), *waits]
    assert noted.said == bursts + [5, ("clock", 5), ("clock", 5)] * tells_time


def test_without_listeners_commands_are_served_once_a_tick_without_waiting() -> None:
    noted = Noted()
    LockStep(noted, noted, ()).advance(tick(1))  # type: ignore[arg-type]
    assert noted.said == [tick(1).samples, TICK_NS, ("spin", 0.0)]


def test_a_clock_that_never_arrives_is_given_up_and_counted(
    nodes: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lockstep, "PATIENCE", 0.1)
    nodes.hosted.wait_for_clock(7 * TICK_NS)
    assert nodes.hosted.lost["/clock"] == 1
    assert nodes.hosted.received()["/clock"] == 0


def test_second_publisher_of_a_topic_fails_the_run(nodes: Nodes) -> None:
    step = LockStep(nodes.bridge, nodes.executor, (nodes.hosted,))
    step.advance(tick(1))
    intruder = nodes.metrics.create_publisher(ImuMessage, "imu/data", 10)
    nodes.until(lambda: intruder.get_subscription_count() > 0)
    intruder.publish(ImuMessage())
    nodes.until(lambda: nodes.metrics.received["/imu/data"] > 1)
    with pytest.raises(RunFailed, match=r"/imu/data has a second publisher.*ROS_DOMAIN_ID"):
        step.advance(tick(2))


@pytest.mark.parametrize("strange_ns", [99 * 10**9, TICK_NS])
def test_second_clock_fails_the_run_also_where_it_tells_a_time_of_ours(
    nodes: Nodes, strange_ns: int
) -> None:
    step = LockStep(nodes.bridge, nodes.executor, (nodes.hosted,))
    for number in (1, 2):
        step.advance(tick(number))
    intruder = nodes.metrics.create_publisher(Clock, "/clock", 10)
    nodes.until(lambda: intruder.get_subscription_count() > 0)
    sec, nanosec = divmod(strange_ns, 10**9)
    intruder.publish(Clock(clock=Time(sec=sec, nanosec=nanosec)))
    nodes.until(lambda: nodes.metrics.get_clock().now().nanoseconds == strange_ns)
    with pytest.raises(RunFailed, match=r"/clock has a second publisher"):
        nodes.hosted.wait_for_clock(3 * TICK_NS)
