"""Samples -> ROS messages. Each message is built once and refilled: publishing copies it.

rclpy serialises a wrongly typed value as garbage without a word, so every field gets exactly its
type: float(...) for float64, an array('f') for ranges, int for sec and nanosec.
"""

from array import array
from collections.abc import Callable
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion, Vector3
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan
from std_msgs.msg import Bool, Float64MultiArray, MultiArrayDimension

from harness import samples
from harness.robots import RoverSpec
from harness.sensors.lidar_spec import LidarSpec

NANOSECONDS = 1_000_000_000
GROUND_TRUTH_POSE_VARIANCE = 0.01  # on the diagonal, as RoboTerrain's PoseConverterNode says

TRAVERSAL = (  # the values of /rover/truth/traversal, in order
    "contact_force",
    *("rock_contact", "scrape"),
    *("speed", "path_length"),
    *("slip_front_left", "slip_rear_left", "slip_front_right", "slip_rear_right"),
    "roughness",
)

Fill = Callable[[Any], Any]  # a sample of the topic's kind -> the refilled message


def set_stamp(stamp: Time, stamp_ns: int) -> None:
    """Writes simulation time into a stamp."""
    stamp.sec, stamp.nanosec = divmod(stamp_ns, NANOSECONDS)


def clock() -> Callable[[int], Clock]:
    """A filler of Clock messages."""
    message = Clock()

    def fill(stamp_ns: int) -> Clock:
        set_stamp(message.clock, stamp_ns)
        return message

    return fill


def laser_scan(lidar: LidarSpec) -> Fill:
    """A filler of LaserScan messages with that lidar's beams.

    scan_time and time_increment are 0, as ros_gz_bridge leaves them.
    """
    message = LaserScan()
    message.header.frame_id = "lidar_link"
    message.angle_min, message.angle_max = -lidar.angle_max, lidar.angle_max
    message.angle_increment = 2 * lidar.angle_max / (lidar.beams - 1)
    message.range_min, message.range_max = lidar.range_min, lidar.range_max
    message.intensities = array("f", bytes(4 * lidar.beams))
    whole = array("f", bytes(4 * lidar.beams))
    ranges = np.frombuffer(whole, dtype=np.float32)

    def fill(scan: samples.LaserScan) -> LaserScan:
        set_stamp(message.header.stamp, scan.stamp_ns)
        if scan.ranges.size == ranges.size:
            ranges[:] = scan.ranges
            message.ranges = whole
        else:  # a faulty lidar
            message.ranges = array("f", scan.ranges.tobytes())
        return message

    return fill


def imu(rover: RoverSpec) -> Fill:
    """A filler of Imu messages; covariances stay 0, as in Gazebo."""
    message = Imu()
    message.header.frame_id = rover.imu_frame

    def fill(reading: samples.Imu) -> Imu:
        set_stamp(message.header.stamp, reading.stamp_ns)
        _set_quaternion(message.orientation, reading.orientation)
        _set_vector(message.angular_velocity, reading.angular_velocity)
        _set_vector(message.linear_acceleration, reading.linear_acceleration)
        return message

    return fill


def pose_array() -> Fill:
    """A filler of PoseArray messages with the one pose."""
    message = PoseArray(poses=[Pose()])
    message.header.frame_id = "world"
    pose = message.poses[0]

    def fill(sample: samples.Pose) -> PoseArray:
        set_stamp(message.header.stamp, sample.stamp_ns)
        message.poses = [] if sample.empty else [pose]
        _set_vector(pose.position, sample.position)
        _set_quaternion(pose.orientation, sample.orientation)
        return message

    return fill


def wheel_odometry(rover: RoverSpec) -> Fill:
    """A filler of wheel Odometry messages; covariances stay 0, as in Gazebo."""
    message = Odometry()
    message.header.frame_id = "odom"
    message.child_frame_id = rover.odometry_child_frame

    def fill(sample: samples.Odometry) -> Odometry:
        set_stamp(message.header.stamp, sample.stamp_ns)
        _set_planar_pose(message, sample.x, sample.y, sample.yaw)
        message.twist.twist.linear.x = sample.twist.linear
        message.twist.twist.angular.z = sample.twist.angular
        return message

    return fill


def ground_truth() -> Fill:
    """A filler of true Odometry messages, planar as RoboTerrain's; the twist is the true one."""
    message = Odometry()
    message.header.frame_id = "odom"
    message.child_frame_id = "base_footprint"
    message.pose.covariance = (np.eye(6) * GROUND_TRUTH_POSE_VARIANCE).ravel()

    def fill(sample: samples.GroundTruth) -> Odometry:
        set_stamp(message.header.stamp, sample.stamp_ns)
        _set_planar_pose(message, sample.x, sample.y, sample.yaw)
        _set_vector(message.twist.twist.linear, sample.linear_velocity)
        _set_vector(message.twist.twist.angular, sample.angular_velocity)
        return message

    return fill


def joint_states(rover: RoverSpec) -> Fill:
    """A filler of JointState messages."""
    message = JointState()
    message.name = list(rover.joints)

    def fill(sample: samples.JointStates) -> JointState:
        set_stamp(message.header.stamp, sample.stamp_ns)
        message.position = array("d", sample.position)
        message.velocity = array("d", sample.velocity)
        message.effort = array("d", sample.effort)
        return message

    return fill


def contact() -> Fill:
    """A filler of Bool messages: whether the rover has touched a hazard."""
    message = Bool()

    def fill(truth: samples.TruthState) -> Bool:
        message.data = truth.hazard_contact
        return message

    return fill


def traversal() -> Fill:
    """A filler of Float64MultiArray messages; the label of the one dimension names the values."""
    size = len(TRAVERSAL)
    message = Float64MultiArray()
    message.layout.dim = [MultiArrayDimension(label=",".join(TRAVERSAL), size=size, stride=size)]

    def fill(truth: samples.TruthState) -> Float64MultiArray:
        message.data = array(
            "d",
            (
                truth.contact_force,
                truth.rock_contact,
                truth.scrape,
                truth.speed,
                truth.path_length,
                *truth.slip,
                truth.roughness,
            ),
        )
        return message

    return fill


def _set_vector(target: Vector3 | Point, value: samples.Vector3) -> None:
    target.x, target.y, target.z = value


def _set_quaternion(target: Quaternion, value: samples.Quaternion) -> None:
    target.x, target.y, target.z, target.w = value


def _set_planar_pose(message: Odometry, x: float, y: float, yaw: float) -> None:
    position, orientation = message.pose.pose.position, message.pose.pose.orientation
    position.x, position.y = x, y
    orientation.z, orientation.w = float(np.sin(yaw / 2)), float(np.cos(yaw / 2))
