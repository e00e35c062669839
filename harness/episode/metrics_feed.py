"""What a run knows of its rover for the extended columns, and how its samples get there without ROS."""

import math

import numpy as np

from harness.robots import RoverSpec
from harness.samples import GroundTruth, Imu, LaserScan, Odometry, Pose, Sample, TruthState
from harness.sensors.lidar_spec import LidarSpec
from rover_metrics.extended.footprint import Footprint, LidarPose
from rover_metrics.extended.metrics import ExtendedMetrics
from rover_metrics.extended.settings import ExtendedSettings


def extended_settings(rover: RoverSpec) -> ExtendedSettings:
    """The rover's footprint and where its lidar is; it looks backwards (models/README.md)."""
    return ExtendedSettings(
        footprint=Footprint.rectangle(*rover.footprint),
        lidar_pose=LidarPose(rover.lidar_x, 0.0, math.pi),
    )


def outline_parameters(rover: RoverSpec) -> dict[str, list[float]]:
    """The same as parameters of a metrics_node."""
    settings = extended_settings(rover)
    corners = () if settings.footprint is None else settings.footprint.corners
    pose = settings.lidar_pose
    return {
        "footprint": [value for corner in corners for value in corner],
        "lidar_pose": [pose.x, pose.y, pose.yaw],
    }


def extended_ros_args(rover: RoverSpec) -> list[str]:
    """The arguments for a metrics_node with extended columns; what the user says after them wins."""
    parameters = {"extended_columns": "true"} | outline_parameters(rover)
    words = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
    return ["--ros-args", *words, "--"]


class SampleIntake:
    """Hands samples to extended metrics as they would come out of messages.

    Attributes:
        metrics: Where they go.
    """

    def __init__(self, metrics: ExtendedMetrics, lidar: LidarSpec) -> None:
        self.metrics = metrics
        # sensor_msgs/LaserScan carries both as float32.
        self._angle_min = float(np.float32(-lidar.angle_max))
        self._angle_increment = float(np.float32(2 * lidar.angle_max / (lidar.beams - 1)))

    def take(self, sample: Sample, *, used: bool) -> None:
        """Takes a sample, and whether the twelve columns have used it."""
        metrics = self.metrics
        match sample:
            case LaserScan():
                metrics.add_scan(
                    sample.stamp_ns,
                    sample.ranges,
                    angle_min=self._angle_min,
                    angle_increment=self._angle_increment,
                    used=used,
                )
            case Imu():
                metrics.add_imu(
                    sample.stamp_ns, sample.linear_acceleration, sample.orientation, used=used
                )
            case Pose():
                metrics.add_pose(sample.stamp_ns, sample.position, used=used)
            case Odometry():
                metrics.add_odometry(sample.stamp_ns, (sample.twist.linear, 0.0, 0.0), used=used)
            case GroundTruth():
                metrics.add_true_velocity(sample.linear_velocity)
            case TruthState():
                metrics.add_contact(touches=sample.hazard_contact)
                metrics.add_traversal(_traversal(sample))


def _traversal(truth: TruthState) -> tuple[float, ...]:
    """The values of /rover/truth/traversal."""
    return (
        truth.contact_force,
        truth.rock_contact,
        truth.scrape,
        truth.speed,
        truth.path_length,
        *truth.slip,
        truth.roughness,
    )
