import math
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from rclpy.serialization import deserialize_message, serialize_message

from harness import samples
from harness.robots import RoverSpec
from harness.ros import messages
from harness.sensors.lidar_spec import LidarSpec
from tests.support.rovers import LEO, ROVER_ZERO4WD

STAMP_NS = 12_345_678_901


def over_the_wire(message: Any) -> Any:  # noqa: ANN401 - any message
    """The message as a subscriber gets it: serialisation is where wrong types turn to garbage."""
    return deserialize_message(serialize_message(message), type(message))


def test_scan_arrives_with_ranges_geometry_stamp_and_frame() -> None:
    ranges = np.array([1.5, np.inf, -np.inf, 0.15], dtype=np.float32)
    fill = messages.laser_scan(LidarSpec(beams=4))
    scan = over_the_wire(fill(samples.LaserScan(STAMP_NS, ranges)))
    assert scan.ranges.tolist() == ranges.tolist()
    assert len(scan.intensities) == 4
    assert (scan.header.stamp.sec, scan.header.stamp.nanosec) == (12, 345_678_901)
    assert scan.header.frame_id == "lidar_link"
    assert (scan.angle_min, scan.angle_max) == pytest.approx((-3.14159, 3.14159))
    assert scan.angle_increment == pytest.approx(2 * 3.14159 / 3)
    assert (scan.range_min, scan.range_max) == pytest.approx((0.15, 10.0))
    assert (scan.scan_time, scan.time_increment) == (0.0, 0.0)


def test_refilling_a_scan_replaces_every_range() -> None:
    fill = messages.laser_scan(LidarSpec(beams=3))
    fill(samples.LaserScan(0, np.ones(3, dtype=np.float32)))
    scan = over_the_wire(fill(samples.LaserScan(1, np.array([2, 3, 4], dtype=np.float32))))
    assert scan.ranges.tolist() == [2.0, 3.0, 4.0]


@pytest.mark.parametrize(("rover", "frame"), [(LEO, "imu_frame"), (ROVER_ZERO4WD, "imu_link")])
def test_imu_arrives_in_the_rovers_frame(rover: RoverSpec, frame: str) -> None:
    reading = samples.Imu(STAMP_NS, (0.1, 0.2, 0.3, 0.9), (1.0, 2.0, 3.0), (4.0, 5.0, 9.8))
    imu = over_the_wire(messages.imu(rover)(reading))
    assert imu.header.frame_id == frame
    assert (imu.orientation.x, imu.orientation.w) == (0.1, 0.9)
    assert (imu.angular_velocity.x, imu.angular_velocity.z) == (1.0, 3.0)
    assert (imu.linear_acceleration.y, imu.linear_acceleration.z) == (5.0, 9.8)
    assert not imu.linear_acceleration_covariance.any()


def test_pose_array_holds_the_one_pose_in_the_world() -> None:
    pose = samples.Pose(STAMP_NS, (1.0, -2.0, 0.5), (0.0, 0.0, 1.0, 0.0))
    arrived = over_the_wire(messages.pose_array()(pose))
    assert arrived.header.frame_id == "world"
    (only,) = arrived.poses
    assert (only.position.x, only.position.y, only.position.z) == (1.0, -2.0, 0.5)
    assert only.orientation.z == 1.0


def test_wheel_odometry_is_planar_with_gazebos_zero_covariance() -> None:
    reading = samples.Odometry(STAMP_NS, 1.0, 2.0, math.pi / 2, samples.Twist(0.3, -0.1))
    odometry = over_the_wire(messages.wheel_odometry(LEO)(reading))
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_footprint")
    assert odometry.pose.pose.orientation.z == pytest.approx(math.sqrt(0.5))
    assert (odometry.twist.twist.linear.x, odometry.twist.twist.angular.z) == (0.3, -0.1)
    assert not odometry.pose.covariance.any()


def test_ground_truth_carries_roboterrains_covariance_and_the_true_twist() -> None:
    truth = samples.GroundTruth(STAMP_NS, 1.0, 2.0, 0.0, (0.3, 0.0, -0.1), (0.0, 0.1, 0.2))
    odometry = over_the_wire(messages.ground_truth()(truth))
    np.testing.assert_allclose(odometry.pose.covariance.reshape(6, 6), np.eye(6) * 0.01)
    assert odometry.twist.twist.linear.z == -0.1
    assert odometry.twist.twist.angular.y == 0.1


def test_joint_states_name_every_joint() -> None:
    values = tuple(float(i) for i in range(6))
    joints = over_the_wire(messages.joint_states(LEO)(samples.JointStates(0, values, values, values)))
    assert joints.name == list(LEO.joints)
    assert joints.position.tolist() == joints.velocity.tolist() == joints.effort.tolist() == list(values)


def test_clock_splits_nanoseconds() -> None:
    clock = over_the_wire(messages.clock()(STAMP_NS)).clock
    assert (clock.sec, clock.nanosec) == (12, 345_678_901)


def test_truth_arrives_on_two_topics_whose_layout_names_the_values() -> None:
    truth = samples.TruthState(
        STAMP_NS,
        hazard_contact=True,
        rock_contact=False,
        scrape=True,
        contact_force=12.5,
        speed=-0.25,
        path_length=3.5,
        slip=(0.1, -0.2, 0.3, -0.4),
        roughness=0.0125,
    )
    assert over_the_wire(messages.contact()(truth)).data is True
    traversal = over_the_wire(messages.traversal()(truth))
    (dimension,) = traversal.layout.dim
    assert dimension.size == dimension.stride == len(traversal.data)
    assert dict(zip(dimension.label.split(","), traversal.data, strict=True)) == {
        "contact_force": 12.5,
        "rock_contact": 0.0,
        "scrape": 1.0,
        "speed": -0.25,
        "path_length": 3.5,
        "slip_front_left": 0.1,
        "slip_rear_left": -0.2,
        "slip_front_right": 0.3,
        "slip_rear_right": -0.4,
        "roughness": 0.0125,
    }
