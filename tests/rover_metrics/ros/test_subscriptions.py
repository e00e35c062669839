"""Publishers that do not fit, and messages that the middleware loses."""

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from geometry_msgs.msg import PoseArray
from nav_msgs.msg import Odometry
from rclpy.event_handler import UnsupportedEventTypeError
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Bool, Float64MultiArray

from rover_metrics.health.reception import LOST, NOT_HEARD, Reception
from rover_metrics.ros import subscriptions
from rover_metrics.topics import SENSORS, TRUTH, Source

if TYPE_CHECKING:
    from tests.rover_metrics.conftest import Rig

pytestmark = [
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
    # rclpy's own report at the publisher's side calls what it deprecates.
    pytest.mark.filterwarnings("ignore:Deprecated in favor of:DeprecationWarning"),
]

SCAN, IMU, POSE, ODOMETRY = SENSORS
GROUND_TRUTH, CONTACT, TRUTH_VALUES = TRUTH
BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
RELIABILITY = "qos_overrides./scan.subscription.reliability"


def test_a_best_effort_publisher_of_scans_is_reported_with_what_to_change(
    rig: "Rig", capfd: pytest.CaptureFixture[str]
) -> None:
    node = rig.start()
    rig.simulator.create_publisher(LaserScan, "scan", BEST_EFFORT)
    rig.spin_until(lambda: node.reception.remarks["/scan"][NOT_HEARD] == 1)
    told = capfd.readouterr().err
    assert "/scan: publisher is not heard: it is best effort and this node asks for reliable" in told
    assert f"make the publisher reliable, or start this node with -p {RELIABILITY}:=best_effort" in told


def test_the_change_that_the_report_names_makes_the_publisher_heard(rig: "Rig") -> None:
    node = rig.start("-p", f"{RELIABILITY}:=best_effort")
    rig.publisher(LaserScan, "scan", BEST_EFFORT).publish(rig.scan(1.0, stamp=1.0))
    rig.spin_until(lambda: node.received["/scan"] == 1)
    assert not node.reception.remarks["/scan"]


def test_the_reliability_parameter_is_described_and_fixed(rig: "Rig") -> None:
    node = rig.start()
    descriptor = node.describe_parameter(RELIABILITY)
    assert descriptor.read_only
    assert "/scan" in descriptor.description
    assert node.get_parameter(RELIABILITY).value == "reliable"
    pose = RELIABILITY.replace("scan", "rover/pose_array")
    assert node.get_parameter(pose).value == "best_effort"


def test_another_policy_that_does_not_fit_is_named() -> None:
    event = SimpleNamespace(last_policy_kind=QoSPolicyKind.DEADLINE)
    told = subscriptions._mend(event, "reliable", RELIABILITY)
    assert told == ": its deadline does not fit; this node asks for reliable, volatile"


class Subscriber:
    """A node of which only the subscribing is real enough; it may refuse events."""

    def __init__(self, *, tells_lost: bool) -> None:
        self.tells_lost = tells_lost
        self.events: list[Any] = []

    def resolve_topic_name(self, name: str) -> str:
        return f"/{name}"

    def declare_parameter(self, _: str, default: str, __: object) -> SimpleNamespace:
        return SimpleNamespace(value=default)

    def create_subscription(self, *asked: object, event_callbacks: Any = None) -> None:  # noqa: ANN401
        self.asked = asked
        if event_callbacks is not None and event_callbacks.message_lost and not self.tells_lost:
            raise UnsupportedEventTypeError
        self.events.append(event_callbacks)


def test_messages_that_the_middleware_reports_lost_are_counted() -> None:
    told: list[str] = []
    node, reception = Subscriber(tells_lost=True), Reception(told.append)
    subscriptions.subscribe(node, SENSORS[0], print, reception)
    (events,) = node.events
    events.message_lost(SimpleNamespace(total_count=3, total_count_change=3))
    events.message_lost(SimpleNamespace(total_count=5, total_count_change=2))
    assert reception.remarks["/scan"][LOST] == 5
    assert told[0] == "/scan: lost on the way (3 so far)"


@pytest.mark.parametrize(
    ("source", "message_type", "reliability", "depth", "known"),
    [
        (SCAN, LaserScan, ReliabilityPolicy.RELIABLE, 10, 1),
        (IMU, Imu, ReliabilityPolicy.RELIABLE, 10, 1),
        (POSE, PoseArray, ReliabilityPolicy.BEST_EFFORT, 1, 1),
        (ODOMETRY, Odometry, ReliabilityPolicy.RELIABLE, 10, 1),
        (GROUND_TRUTH, Odometry, ReliabilityPolicy.RELIABLE, 10, 0),
        (CONTACT, Bool, ReliabilityPolicy.RELIABLE, 10, 0),
        (TRUTH_VALUES, Float64MultiArray, ReliabilityPolicy.RELIABLE, 10, 0),
    ],
    ids=lambda value: value.name if isinstance(value, Source) else "",
)
@pytest.mark.parametrize("tells_lost", [True, False])
def test_every_policy_of_a_subscription_is_what_its_source_asks_for(
    source: Source,
    message_type: type,
    reliability: ReliabilityPolicy,
    depth: int,
    known: int,
    tells_lost: bool,
) -> None:
    node, reception = Subscriber(tells_lost=tells_lost), Reception(print)
    assert subscriptions.subscribe(node, source, print, reception) == source.name
    kind, name, callback, qos = node.asked
    assert (kind, name, callback) == (message_type, source.name.removeprefix("/"), print)
    assert isinstance(qos, QoSProfile)
    assert (qos.reliability, qos.history, qos.depth, qos.durability) == (
        reliability,
        HistoryPolicy.KEEP_LAST,
        depth,
        DurabilityPolicy.VOLATILE,
    )
    assert len(reception.states()) == known


def test_poses_overwritten_in_the_queue_are_seen_by_the_gap_of_their_stamps(rig: "Rig") -> None:
    node = rig.start()
    poses = rig.publisher(PoseArray, "rover/pose_array")
    for number in range(1, 31):
        poses.publish(rig.pose(0.0, 0.0, 0.0, stamp=number / 50))
        rig.spin_until(lambda number=number: node.received["/rover/pose_array"] == number)  # type: ignore[misc]
    node.reception.look(0, 0)
    for number in range(31, 42):  # none of them is taken in time but the latest
        poses.publish(rig.pose(0.0, 0.0, 0.0, stamp=number / 50))
    rig.spin_until(lambda: node.reception._stamps["/rover/pose_array"]._last == 820_000_000)
    missing = node.reception.remarks["/rover/pose_array"].total()
    assert missing + node.received["/rover/pose_array"] == 41
