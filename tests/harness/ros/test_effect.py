"""Outputs that time waits for: of one rover of several, of what faults leave of the inputs."""

from collections.abc import Sequence
from threading import Thread

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import Twist
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import LaserScan as LaserScanMessage
from std_msgs.msg import Float64

from harness.base.errors import RunFailed
from harness.base.sim_time import TICK_NS
from harness.ros.bridge import Listener
from harness.ros.effect import AwaitedEffect
from harness.samples import LaserScan, Tick
from harness.spec.ros import Effect
from tests.support.ros import Ros
from tests.support.waiting import PATIENCE


@pytest.mark.parametrize(
    ("ros", "name", "called"),
    [
        (("--ros-args", "-r", "said:=/answer"), "a", ("said", "scan")),
        ((), "b", ("/answer", "/b/scan")),
    ],
    indirect=["ros"],
)
def test_time_waits_for_an_answer_to_each_scan_of_a_rover_that_was_sent(
    ros: Ros, name: str, called: tuple[str, str]
) -> None:
    first = ros.bridge(namespace="a")
    rovers = first, ros.bridge(namespace="b", clock=first.clock_channel)
    answers, silent = list[int](), False
    node = rclpy.create_node("away", context=ros.context, enable_rosout=False)
    publisher = node.create_publisher(Float64, "/answer", 10)

    def answer(scan: LaserScanMessage) -> None:
        if not silent:
            answers.append(scan.header.stamp.nanosec)
            publisher.publish(Float64())

    node.create_subscription(LaserScanMessage, f"/{name}/scan", answer, 10)

    elsewhere = SingleThreadedExecutor(context=ros.context)
    elsewhere.add_node(node)
    spinning = Thread(target=elsewhere.spin, daemon=True)
    spinning.start()
    for end in (node.destroy_node, spinning.join, elsewhere.shutdown):  # the last one first
        ros.at_end.callback(end)

    def effect(timeout: float) -> Sequence[Listener]:
        effects = [Effect(topic=called[0], newer_than=called[1], timeout=timeout)]
        return [AwaitedEffect(effect, rovers) for effect in effects]

    def advance(number: int, scans: int, listeners: Sequence[Listener]) -> None:
        stamp = number * TICK_NS
        tick = Tick(stamp, (LaserScan(stamp, np.ones(4, np.float32)),) * scans)
        for bridge in rovers:
            bridge.send(tick, tick, listeners=listeners)
        first.publish_clock(tick, listeners=listeners, others=rovers[1:])

    waiting = effect(PATIENCE)
    ros.until(publisher.get_subscription_count)
    for number, scans in enumerate((1, 0, 2, 1), 1):  # one lost, one sent twice
        advance(number, scans, waiting)
    assert answers == [TICK_NS * number for number in (1, 3, 3, 4)]
    silent, waiting = True, effect(0.1)
    advance(5, 0, waiting)
    with pytest.raises(RunFailed, match=rf"no /answer .* for the /{name}/scan of 0\.06 s"):
        advance(6, 1, waiting)


def test_commands_that_were_too_many_are_no_answer_to_the_next_scan(ros: Ros) -> None:
    bridge, node = ros.bridge(), rclpy.create_node("away", context=ros.context, enable_rosout=False)
    ros.at_end.callback(node.destroy_node)
    publisher = node.create_publisher(Twist, "/cmd_vel", 10)
    node.create_subscription(LaserScanMessage, "/scan", lambda _: None, 10)
    effect = Effect(topic="/cmd_vel", newer_than="/scan", timeout=0.1)
    listeners = [AwaitedEffect(effect, [bridge])]
    ros.until(publisher.get_subscription_count)
    for _ in range(3):
        publisher.publish(Twist())
    ros.until(lambda: bridge.commands.count.taken == 3)
    tick = Tick(TICK_NS, (LaserScan(TICK_NS, np.ones(4, np.float32)),))
    with pytest.raises(RunFailed, match="no /cmd_vel"):
        bridge.advance(tick, tick, listeners=listeners)
