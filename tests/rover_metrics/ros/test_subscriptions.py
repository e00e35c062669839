"""Publishers that do not fit, and messages that the middleware loses."""

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from rclpy.event_handler import UnsupportedEventTypeError
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan

from rover_metrics.extended.settings import Settings
from rover_metrics.health.reception import LOST, NOT_HEARD, Reception
from rover_metrics.ros.subscriptions import Listening
from rover_metrics.topics import SENSORS, TRUTH
from tests.rover_metrics.conftest import Rig

pytestmark = [
    # rclpy's own report at the publisher's side calls what it deprecates.
    pytest.mark.filterwarnings("ignore:Deprecated in favor of:DeprecationWarning"),
]

SCAN, IMU, POSE, ODOMETRY = SENSORS
GROUND_TRUTH, CONTACT, TRUTH_VALUES = TRUTH
BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
RELIABILITY = "qos_overrides./scan.subscription.reliability"


def test_a_best_effort_publisher_is_reported_with_the_mend(
    rig: Rig, capfd: pytest.CaptureFixture[str]
) -> None:
    node = rig.start()
    rig.simulator.create_publisher(LaserScan, "scan", BEST_EFFORT)
    rig.spin_until(lambda: node.reception.remarks["/scan"][NOT_HEARD] == 1)
    told = capfd.readouterr().err
    assert "/scan: publisher is not heard: it is best effort and this node asks for reliable" in told
    assert f"reliable, or start this node with -p {RELIABILITY}:=best_effort" in told


def test_the_change_that_the_report_names_makes_the_publisher_heard(rig: Rig) -> None:
    node = rig.start("-p", f"{RELIABILITY}:=best_effort")
    rig.publisher(LaserScan, "scan", BEST_EFFORT).publish(rig.scan(1.0, stamp=1.0))
    rig.spin_until(lambda: node.received["/scan"] == 1)
    assert not node.reception.remarks["/scan"]


class Subscriber:
    """A node of which only the subscribing is real enough; it may refuse events."""

    def __init__(self, *, tells_lost: bool) -> None:
        self.tells_lost, self.take = tells_lost, print
        self.reception, self.settings = Reception(print), Settings()
        self.events: list[Any] = []

    def resolve_topic_name(self, name: str) -> str:
        return f"/{name}"

    def declare_parameter(self, _: str, default: str, __: object) -> SimpleNamespace:
        return SimpleNamespace(value=default)

    def create_subscription(self, *asked: object, raw: bool, event_callbacks: Any = None) -> None:  # noqa: ANN401
        assert raw
        self.asked = asked
        if event_callbacks is not None and event_callbacks.message_lost and not self.tells_lost:
            raise UnsupportedEventTypeError
        self.events.append(event_callbacks)


def test_lost_messages_are_counted_where_the_middleware_tells_of_them() -> None:
    node = Subscriber(tells_lost=True)
    Listening(node, SENSORS[0])
    for total, new in ((3, 3), (5, 2)):
        node.events[0].message_lost(SimpleNamespace(total_count=total, total_count_change=new))
    assert node.reception.remarks["/scan"][LOST] == 5
    node = Subscriber(tells_lost=False)  # is listened to all the same
    assert Listening(node, SENSORS[0]).topic == "/scan"
    assert node.events == [None]


def test_every_policy_of_a_subscription_is_what_its_source_asks_for(rig: Rig) -> None:
    node = rig.start(extended_columns=True)
    asked = {each.topic_name: each for each in node.subscriptions if each.topic_name in node.received}
    reliable, depth = dict.fromkeys(asked, "RELIABLE"), dict.fromkeys(asked, 10)
    reliable["/rover/pose_array"], depth["/rover/pose_array"] = "BEST_EFFORT", 1
    policies = {topic: each.qos_profile for topic, each in asked.items()}
    assert {topic: qos.reliability.name for topic, qos in policies.items()} == reliable
    assert {topic: qos.depth for topic, qos in policies.items()} == depth
    assert {qos.history for qos in policies.values()} == {HistoryPolicy.KEEP_LAST}
    assert {qos.durability for qos in policies.values()} == {DurabilityPolicy.VOLATILE}
    assert {state.topic for state in node.reception.states()} == {each.name for each in SENSORS}
