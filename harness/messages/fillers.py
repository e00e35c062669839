"""Samples -> ROS messages: what of a topic's message does not change, and where the rest comes from."""

import math
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import fields
from operator import attrgetter
from typing import Any

import numpy as np

from harness import samples
from harness.base.errors import UsageError
from harness.base.message_types import made
from harness.messages import optional
from harness.messages.blank import Message, blank, kind_of
from harness.messages.refilled import Fill, refilled
from harness.robots import RoverSpec
from harness.robots.frames.tree import FOOTPRINT
from harness.robots.lidar import LidarSpec
from harness.sensors.battery import Battery, BatteryOptions
from harness.sensors.camera.lens import Pinhole
from harness.sensors.camera.sensor import CameraOptions
from harness.sensors.depth import DepthOptions
from harness.sensors.gnss import GnssFix, GnssOptions
from harness.sensors.height_scan import HeightScanOptions
from harness.sensors.lidars import CloudLidarOptions, PlanarLidarOptions
from harness.sensors.noise import NoisePreset
from harness.sensors.optional import SensorOptions
from harness.sensors.table import POINT_CLOUD, SensorRow, Topic
from rover_metrics.extended.truth_columns import traversal_names
from rover_metrics.topics import UNKNOWN

IN_ANY = {"stamp_ns", "sensor"}  # the fields that every plug-in's sample has
POSE, POSES = "geometry_msgs/msg/Pose", "geometry_msgs/msg/PoseArray"
SCAN, IMU, ODOMETRY = "sensor_msgs/msg/LaserScan", "sensor_msgs/msg/Imu", "nav_msgs/msg/Odometry"
JOINTS, FIX, BATTERY = (
    f"sensor_msgs/msg/{name}" for name in ("JointState", "NavSatFix", "BatteryState")
)
IMAGE, CAMERA_INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
BOOL, NUMBERS = "std_msgs/msg/Bool", "std_msgs/msg/Float64MultiArray"
DIMENSION = "std_msgs/msg/MultiArrayDimension"
GROUND_TRUTH_POSE_VARIANCE = 0.01  # on the diagonal, as RoboTerrain's PoseConverterNode says


def filler(
    row: SensorRow, topic: Topic, rover: RoverSpec, lidar: LidarSpec, draw: optional.Draw | None = None
) -> Fill:
    """Returns what makes messages of a sensor's samples: of FILLERS, of OF_OPTIONS, or `by_names`.

    Args:
        row: The sensor.
        topic: One of its topics.
        rover: Gives the frames.
        lidar: Gives the geometry of scans.
        draw: Gives the images of cameras; without it there are none.
    """
    if isinstance(row.given, HeightScanOptions):
        return optional.grid_map_fill(row.given)
    message = blank(topic.message_type)
    if hasattr(message, "header"):
        message.header.frame_id = row.frame_on(rover)
    if topic.message_type == IMAGE and isinstance(row.given, CameraOptions):
        return optional.image_fill(message, row.given, draw)
    of_options = OF_OPTIONS.get((type(row.given), topic.message_type))
    if of_options is not None:
        return of_options(message, row.given)
    if row.noise is not None:
        _tell_errors(message, row.sample, row.noise)
    special = FILLERS.get((row.sample, topic.message_type))
    return by_names(message, row.sample) if special is None else special(message, rover, lidar)


def _tell_errors(message: Message, sample: type[samples.Sample], noise: NoisePreset) -> None:
    """Fills covariances in: of a new sensor's errors, diagonal; zeros, which mean unknown, of none."""
    if kind_of(message) == IMU:
        for name, errors in (
            ("orientation", noise.attitude),
            ("angular_velocity", noise.angular_velocity),
            ("linear_acceleration", noise.acceleration),
        ):
            setattr(message, f"{name}_covariance", (np.eye(3) * errors.variance).ravel())
    elif sample is samples.Odometry and any(noise.twist_variance):
        covariance = np.zeros((6, 6))
        covariance[0, 0], covariance[5, 5] = noise.twist_variance
        message.twist.covariance = covariance.ravel()
        message.pose.covariance[0] = UNKNOWN  # an integrated pose is off without bound


def person(index: int) -> Fill:
    """Returns a filler of the pose of one of the people; as RoboTerrain's, it has no stamp."""
    return refilled(
        blank(POSE),
        {
            "position": lambda sample: sample.position[index],
            "orientation": lambda sample: sample.orientation[index],
        },
    )


def goal() -> Fill:
    """Returns a filler of goals in the world, which is the map."""
    message = blank("geometry_msgs/msg/PoseStamped")
    message.header.frame_id = "map"
    parts = ("position", "orientation")
    return refilled(message, {f"pose.{part}": attrgetter(part) for part in parts})


def by_names(message: Message, sample_type: type, **others: str) -> Fill:
    """Returns a filler of the stamp and of every field whose name the sample has too, and of others."""
    names = {item.name: item.name for item in fields(sample_type) if hasattr(message, item.name)}
    own = {item.name for item in fields(sample_type)} - IN_ANY
    if own and not names and not others and not sample_type.__module__.startswith("harness."):
        text = f"{kind_of(message)} has none of the fields of {sample_type.__qualname__}"
        theirs = (name for name in vars(message) if not name.startswith("_"))
        raise UsageError(f"{text}; call them as the message does: {', '.join(theirs)}")
    return refilled(message, {path: attrgetter(name) for path, name in (names | others).items()})


def _laser_scan(message: Message, _: RoverSpec, lidar: LidarSpec) -> Fill:
    message.angle_min, message.angle_max = -lidar.angle_max, lidar.angle_max
    message.angle_increment = 2 * lidar.angle_max / (lidar.beams - 1)
    message.range_min, message.range_max = lidar.range_min, lidar.range_max
    message.intensities = np.zeros(lidar.beams, np.float32)
    return optional.scan_fill(message)


def _pose_array(message: Message, _: RoverSpec, __: LidarSpec) -> Fill:
    empty = refilled(deepcopy(message), {})
    message.poses = [blank(POSE)]
    sources = {f"poses[0].{name}": attrgetter(name) for name in ("position", "orientation")}
    whole = refilled(message, sources)
    return lambda sample: empty(sample) if sample.empty else whole(sample)


def _planar(sample: samples.Odometry | samples.GroundTruth) -> samples.Quaternion:
    """The attitude of a sample that has a yaw only."""
    half = sample.yaw / 2 if math.isfinite(sample.yaw) else math.nan  # a fault's infinite yaw
    return 0.0, 0.0, float(np.sin(half)), float(np.cos(half))


PLANAR_POSE: Mapping[str, Callable[[Any], object]] = {
    "pose.pose.position.x": attrgetter("x"),
    "pose.pose.position.y": attrgetter("y"),
    "pose.pose.orientation": _planar,
}


def _wheel_odometry(message: Message, rover: RoverSpec, _: LidarSpec) -> Fill:
    """Wheel odometry; covariances are 0, as in Gazebo, unless noise has set some."""
    message.child_frame_id = rover.odometry_child_frame
    linear, angular = attrgetter("twist.linear"), attrgetter("twist.angular")
    twist = {"twist.twist.linear.x": linear, "twist.twist.angular.z": angular}
    return refilled(message, {**PLANAR_POSE, **twist})


def _ground_truth(message: Message, _: RoverSpec, __: LidarSpec) -> Fill:
    """True odometry, planar as RoboTerrain's; the twist is the true one."""
    message.child_frame_id = FOOTPRINT
    message.pose.covariance = (np.eye(6) * GROUND_TRUTH_POSE_VARIANCE).ravel()
    linear, angular = attrgetter("linear_velocity"), attrgetter("angular_velocity")
    twist = {"twist.twist.linear": linear, "twist.twist.angular": angular}
    return refilled(message, {**PLANAR_POSE, **twist})


def _joint_states(message: Message, rover: RoverSpec, _: LidarSpec) -> Fill:
    message.name = list(rover.joints)
    return by_names(message, samples.JointStates)


def _contact(message: Message, _: RoverSpec, __: LidarSpec) -> Fill:
    return refilled(message, {"data": attrgetter("hazard_contact")})


def _traversal(message: Message, rover: RoverSpec, _: LidarSpec) -> Fill:
    """The values of the truth; the label of the one dimension names them."""

    def of(message: Message, *, soil: bool) -> Fill:
        names = traversal_names(rover.wheel_names, soil=soil)
        size = len(names)
        message.layout.dim = [made(DIMENSION, ",".join(names), size, size)]
        return refilled(message, {"data": attrgetter("traversal")})

    rigid, on_soil = of(message, soil=False), of(blank(NUMBERS), soil=True)
    return lambda sample: (rigid if sample.soil is None else on_soil)(sample)


def _nav_sat_fix(message: Message, _: SensorOptions) -> Fill:
    """Fixes of a receiver for GPS, GLONASS, BeiDou and Galileo."""
    status = message.status
    used = status.SERVICE_GPS | status.SERVICE_GLONASS | status.SERVICE_COMPASS
    status.service = used | status.SERVICE_GALILEO
    return by_names(message, GnssFix, **{"status.status": "fix"})


def _battery_state(message: Message, _: BatteryOptions) -> Fill:
    """What a battery with a gauge of charge tells; what it does not measure is NaN."""
    message.temperature = message.capacity = message.design_capacity = math.nan
    message.power_supply_status = message.POWER_SUPPLY_STATUS_DISCHARGING
    message.present = True
    return by_names(message, Battery)


def _motor_currents(message: Message, _: BatteryOptions) -> Fill:
    """The currents of the left and the right side's motors [A]."""
    message.layout.dim = [made(DIMENSION, "left,right", 2, 2)]
    return refilled(message, {"data": attrgetter("motor_currents")})


FILLERS: dict[tuple[type, str], Callable[[Message, RoverSpec, LidarSpec], Fill]] = {
    (samples.LaserScan, SCAN): _laser_scan,
    (samples.Pose, POSES): _pose_array,
    (samples.Odometry, ODOMETRY): _wheel_odometry,
    (samples.GroundTruth, ODOMETRY): _ground_truth,
    (samples.JointStates, JOINTS): _joint_states,
    (samples.TruthState, BOOL): _contact,
    (samples.TruthState, NUMBERS): _traversal,
}
# Of optional sensors, by the class of their options.
OF_OPTIONS: dict[tuple[type, str], Callable[[Message, Any], Fill]] = {
    (PlanarLidarOptions, SCAN): optional.laser_scan,
    (CloudLidarOptions, POINT_CLOUD): optional.lidar_cloud,
    (DepthOptions, POINT_CLOUD): optional.depth_cloud,
    (DepthOptions, IMAGE): optional.depth_image,
    (DepthOptions, CAMERA_INFO): lambda message, given: optional.lens_info(
        message, Pinhole(given.width, given.height, given.fov)
    ),
    (CameraOptions, CAMERA_INFO): lambda message, given: optional.lens_info(message, given.lens_of()),
    (GnssOptions, FIX): _nav_sat_fix,
    (BatteryOptions, BATTERY): _battery_state,
    (BatteryOptions, NUMBERS): _motor_currents,
}
