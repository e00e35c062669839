"""Extended columns through a MetricsNode over real DDS."""

# the skip stands before the imports that need ROS

import csv
import math
from typing import TYPE_CHECKING, Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from geometry_msgs.msg import PoseArray
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64MultiArray, MultiArrayDimension

from rover_metrics.extended.metrics import EXTENDED_HEADER
from rover_metrics.extended.truth_columns import WHEELS, traversal_names
from rover_metrics.health.rejections import BELOW_LIMIT
from rover_metrics.topics import SENSORS, TRUTH

if TYPE_CHECKING:
    from rover_metrics.metrics_node import MetricsNode
    from tests.rover_metrics.conftest import Rig

# The rosidl wheels import an old lark, which imports a deprecated module of the standard library.
pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")

SCAN, IMU, POSE, ODOMETRY = SENSORS
GROUND_TRUTH, CONTACT, TRUTH_VALUES = TRUTH


def start(rig: "Rig", **parameters: Any) -> "MetricsNode":  # noqa: ANN401
    return rig.start(extended_columns=True, use_sim_time=True, **parameters)


def row(node: "MetricsNode") -> dict[str, Any]:
    node.periodic_logging()
    assert node.last_row is not None
    return dict(zip(node.last_row.columns, node.last_row.as_fields(), strict=True))


def test_every_field_of_every_message_reaches_its_columns(rig: "Rig") -> None:
    """Through DDS: angles and limits of a scan, the first pose of several, turned IMU, named truth."""
    wide = [-0.2, -0.1, 0.2, -0.1, 0.2, 0.1, -0.2, 0.1]
    node = start(rig, footprint=wide, collision_threshold=1.0, gravity=10.0)
    scan = rig.scan(0.5, 3.0, stamp=1.0, limits=(0.6, 2.0))
    scan.angle_min, scan.angle_increment = math.pi / 2, 0.1  # the nearest is on the left
    turned = rig.imu((0.0, 9.6, 2.8), (0.0, 3.0, 4.0), stamp=2.0)
    turned.orientation.x, turned.orientation.w = 0.6, 0.8
    poses = rig.pose(1.0, 2.0, 2.0, stamp=3.0)
    poses.poses = [*poses.poses, *rig.pose(9.0, 9.0, 9.0).poses]
    names = list(traversal_names(WHEELS))[::-1]
    truth = Float64MultiArray(data=[0.02, 0.4, 0.3, 0.2, 0.1, 9.0, 0.5, 0.0, 0.0, 0.0])
    truth.layout.dim = [MultiArrayDimension(label=",".join(names), size=10, stride=10)]
    messages = {
        "scan": scan,
        "imu/data": turned,
        "rover/pose_array": poses,
        "odometry/wheels": rig.odometry(0.2, 0.3, -0.6, stamp=4.0),
        "odom_ground_truth": rig.odometry(0.3, 0.4, 0.0, stamp=1.0),
        "rover/truth/contact": Bool(data=True),
        "rover/truth/traversal": truth,
    }
    for topic, message in messages.items():
        rig.publisher(type(message), topic).publish(message)
    rig.spin_until(lambda: all(node.received[f"/{topic}"] == 1 for topic in messages))
    node.take(POSE, rig.pose(1.1, 2.2, 2.2, stamp=3.5))
    cells = row(node)
    assert cells["Footprint Clearance [m]"] == 0.4
    assert cells["Total Collisions"] == cells["Collision Events"] == 1
    assert (cells["Roughness RMS [m/s^2]"], cells["Current Smoothness"]) == (0.0, 15.0)
    assert (cells["Distance Traveled"], cells["Current Velocity"]) == (0.3, 0.7)
    ages = [cells[f"{name} Age [s]"] for name in ("Scan", "IMU", "Pose", "Odometry")]
    assert ages == [-1.0, -2.0, -3.5, -4.0]  # no /clock yet
    assert (cells["True Contact Events"], cells["True Speed [m/s]"]) == (1, 0.5)
    slips = [cells[f"True Slip {wheel.replace('_', ' ').title()}"] for wheel in WHEELS]
    assert (slips, cells["True Roughness [m]"]) == ([0.1, 0.2, 0.3, 0.4], 0.02)
    remarks = {topic: dict(counts) for topic, counts in node.reception.remarks.items() if counts}
    assert remarks == {"/scan": {BELOW_LIMIT: 1}}
    with node.log.path.open(newline="") as file:
        assert [*csv.reader(file)] == [[*EXTENDED_HEADER], [str(cell) for cell in cells.values()]]


def test_an_orientation_that_is_said_to_be_none_is_none_and_truth_without_names_has_the_usual(
    rig: "Rig",
) -> None:
    node = start(rig)
    tilted = rig.imu((1.0, 0.0, 9.8), stamp=1.0)
    tilted.orientation.x, tilted.orientation.w = 0.6, 0.8
    tilted.orientation_covariance[0] = -1.0
    node.take(IMU, tilted)
    node.take(TRUTH_VALUES, Float64MultiArray(data=[0.0] * 9 + [0.02]))
    node.take(CONTACT, Bool(data=False))
    cells = row(node)
    assert cells["Roughness RMS [m/s^2]"] == 0.0  # the first sample is gravity
    assert (cells["True Roughness [m]"], cells["True Contact Share"]) == (0.02, 0.0)


def test_topics_follow_the_namespace_and_a_remap_and_what_each_lost_is_in_its_column(rig: "Rig") -> None:
    remaps = ("-r", "__ns:=/leo", "-r", "scan:=front/scan")
    node = rig.start(*remaps, extended_columns=True, use_sim_time=True)
    sensors = ("front/scan", "imu/data", "rover/pose_array", "odometry/wheels")
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
