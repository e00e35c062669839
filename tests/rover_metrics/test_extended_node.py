"""Extended columns through a MetricsNode over real DDS."""

# the skip stands before the imports that need ROS

import csv
from typing import TYPE_CHECKING, Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from geometry_msgs.msg import PoseArray
from rclpy.parameter import Parameter
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64MultiArray, MultiArrayDimension

from rover_metrics.core.columns import COLUMNS
from rover_metrics.extended.metrics import EXTENDED_HEADER
from rover_metrics.extended.truth_columns import WHEELS, traversal_names
from rover_metrics.topics import SENSORS, TRUTH

if TYPE_CHECKING:
    from rover_metrics.metrics_node import MetricsNode
    from tests.rover_metrics.conftest import Rig

# The rosidl wheels import an old lark, which imports a deprecated module of the standard library.
pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")

SCAN, IMU, POSE, ODOMETRY = SENSORS
GROUND_TRUTH, CONTACT, TRUTH_VALUES = TRUTH
SQUARE = [0.2, 0.2, -0.2, 0.2, -0.2, -0.2, 0.2, -0.2]


def start(rig: "Rig", **parameters: object) -> "MetricsNode":
    return rig.start(extended_columns=True, use_sim_time=True, **parameters)


def row(node: "MetricsNode") -> dict[str, Any]:
    node.periodic_logging()
    assert node.last_row is not None
    return dict(zip(node.last_row.columns, node.last_row.as_fields(), strict=True))


def test_messages_of_every_topic_reach_their_columns(rig: "Rig") -> None:
    node = start(rig, footprint=SQUARE)
    truth = Float64MultiArray(data=[0.0, 0.0, 0.0, 0.5, 9.0, 0.1, 0.2, 0.3, 0.4, 0.02])
    truth.layout.dim = [MultiArrayDimension(label=",".join(traversal_names(WHEELS)), size=10, stride=10)]
    tilted = rig.imu((1.0, 0.0, 9.8), stamp=1.0)
    tilted.orientation.x, tilted.orientation.w = 0.6, 0.8
    tilted.orientation_covariance[0] = -1.0  # which says that there is none
    messages = {
        "scan": rig.scan(0.5, stamp=1.0),
        "imu/data": tilted,
        "rover/pose_array": rig.pose(0.0, 0.0, 0.0, stamp=1.0),
        "odometry/wheels": rig.odometry(0.5, 0.0, 0.0, stamp=1.0),
        "odom_ground_truth": rig.odometry(0.3, 0.4, 0.0, stamp=1.0),
        "rover/truth/contact": Bool(data=True),
        "rover/truth/traversal": truth,
    }
    for topic, message in messages.items():
        rig.publisher(type(message), topic).publish(message)
    rig.spin_until(lambda: all(node.received[f"/{topic}"] == 1 for topic in messages))
    cells = row(node)
    assert cells["Footprint Clearance [m]"] == 0.3
    assert cells["Roughness RMS [m/s^2]"] == 0.0  # no orientation: the first sample is gravity
    assert cells["Scan Age [s]"] == -1.0  # no /clock yet
    assert (cells["True Contact Events"], cells["True Speed [m/s]"]) == (1, 0.5)
    assert (cells["True Slip Rear Right"], cells["True Roughness [m]"]) == (0.4, 0.02)
    with node.log.path.open(newline="") as file:
        header, *rows = csv.reader(file)
    assert tuple(header) == EXTENDED_HEADER
    assert rows == [[str(cell) for cell in cells.values()]]
    assert node.reception.rejected == dict.fromkeys(node.received, 0)


def test_the_truth_follows_the_namespace_and_what_is_lost_of_each_sensor_is_in_its_column(
    rig: "Rig",
) -> None:
    node = rig.start("-r", "__ns:=/leo", extended_columns=True, use_sim_time=True)
    sensors = ("scan", "imu/data", "rover/pose_array", "odometry/wheels")
    truth = ("odom_ground_truth", "rover/truth/contact", "rover/truth/traversal")
    assert set(node.received) == {f"/leo/{topic}" for topic in (*sensors, *truth)}
    node.take(SCAN, rig.scan(1.0))
    node.take(IMU, rig.imu((0.0, 0.0, 9.8)))
    node.take(POSE, rig.pose(0.0, 0.0, 0.0))
    node.take(ODOMETRY, rig.odometry(0.0, 0.0, 0.0))
    for lost, topic in enumerate(sensors, start=1):
        node.reception.remark(f"/leo/{topic}", "lost on the way", lost)
        node.reception.remark(f"/leo/{topic}", "something else", 50)
    cells = row(node)
    told = [cells[f"{name} Lost"] for name in ("Scan", "IMU", "Pose", "Odometry")]
    assert told == [1, 2, 3, 4]


def test_without_the_parameter_nothing_listens_to_the_truth_and_the_log_has_twelve_columns(
    rig: "Rig",
) -> None:
    node = rig.start()
    assert "/rover/truth/contact" not in node.received
    assert tuple(node.log.path.read_text().rstrip().split(",")) == COLUMNS


def test_the_footprint_can_be_set_and_changed_while_the_node_runs(rig: "Rig") -> None:
    node = start(rig)
    node.take(SCAN, rig.scan(0.5))
    assert row(node)["Footprint Clearance [m]"] == ""
    for footprint, pose, clearance in (
        (SQUARE, [0.0, 0.0, 0.0], 0.3),
        (SQUARE, [0.1, 0.0, 0.0], 0.4),
        ([2.0 * value for value in SQUARE], [0.1, 0.0, 0.0], 0.2),
    ):
        changes = [Parameter("footprint", value=footprint), Parameter("lidar_pose", value=pose)]
        assert node.set_parameters_atomically(changes).successful
        node.take(SCAN, rig.scan(0.5))
        assert row(node)["Footprint Clearance [m]"] == clearance


def test_callbacks_serve_every_topic_and_refuse_what_the_twelve_refuse_and_another_truth(
    rig: "Rig", capfd: pytest.CaptureFixture[str]
) -> None:
    node = start(rig)
    node.take(SCAN, LaserScan())
    node.take(IMU, rig.imu((float("nan"), 0.0, 0.0)))
    node.take(POSE, PoseArray())
    node.take(ODOMETRY, rig.odometry(float("inf"), 0.0, 0.0))
    node.take(GROUND_TRUTH, rig.odometry(float("nan"), 0.0, 0.0))
    node.take(TRUTH_VALUES, Float64MultiArray(data=[1.0]))
    cells = row(node)
    rejected = {name: cells[f"{name} Rejected"] for name in ("Scan", "IMU", "Pose", "Odometry")}
    assert rejected == {"Scan": 0, "IMU": 1, "Pose": 1, "Odometry": 1}
    assert cells["True Roughness [m]"] == ""
    truth = ("/odom_ground_truth", "/rover/truth/traversal")
    assert [node.reception.rejected[topic] for topic in truth] == [1, 1]
    assert capfd.readouterr().err.count("not the truth that harness.run publishes, left out") == 2
