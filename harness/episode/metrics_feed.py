"""How samples become rows without ROS, and what a run knows of its rover for the extended columns."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.episode.assembly import gravity, tells_energy
from harness.robots import RoverSpec, find_rover
from harness.robots.lidar import LidarSpec
from harness.samples import (
    GroundTruth,
    Imu,
    LaserScan,
    Odometry,
    Pose,
    Sample,
    TruthState,
    source,
)
from harness.sensors import table
from harness.sensors.battery import Battery
from harness.spec.run import Run
from rover_metrics.extended.footprint import Footprint, LidarPose
from rover_metrics.extended.settings import ExtendedSettings, Settings
from rover_metrics.session import MetricsSession, Remark
from rover_metrics.topics import ENERGY, sources_of

if TYPE_CHECKING:
    from harness.episode.diagnostics import Diagnostics

BATTERY = "battery"  # the sensor whose topic the columns of energy are made of; others have others


def extended_settings(
    rover: RoverSpec, gravity: float | None = None, *, soil: bool = False, energy: bool = False
) -> ExtendedSettings:
    """Returns what a run knows of its rover.

    Args:
        rover: Has footprint and lidar.
        gravity: Of its world [m/s^2]; its model's if None.
        soil: Whether its world has some.
        energy: Whether it carries a battery.
    """
    return ExtendedSettings(
        footprint=Footprint.rectangle(rover.footprint),
        lidar_pose=LidarPose(rover.lidar_x, rover.lidar_y, rover.lidar_yaw),
        gravity=rover.gravity if gravity is None else gravity,
        wheels=",".join(rover.wheel_names),
        soil=soil,
        energy=energy,
    )


def metric_settings(run: Run, values: Mapping[str, Any], number: int = 0, *, extended: bool) -> Settings:
    """Returns the settings of the metrics of a rover.

    Args:
        run: Says what the extended columns are made with.
        values: Parameters that are not the defaults, by name.
        number: The rover's place in the run.
        extended: Whether the log is to have the extended columns.
    """
    settings = Settings()
    if extended:
        rover = run.rovers[number]
        of_run = extended_settings(
            find_rover(rover.robot), gravity(run), soil=bool(run.world.soil), energy=tells_energy(rover)
        )
        settings = Settings(extended_columns=True, extended=of_run)
    return settings.updated(values)


class SampleFeed:
    """Hands samples to a session of metrics as they would come out of messages.

    It counts those it has taken in `fed`, by the name of the topic that each would have had.
    """

    def __init__(self, session: MetricsSession, lidar: LidarSpec) -> None:
        self._session = session
        increment = 2 * lidar.angle_max / (lidar.beams - 1)
        # sensor_msgs/LaserScan carries both as float32.
        self._angles = float(np.float32(-lidar.angle_max)), float(np.float32(increment))
        heard = {each.name for each in sources_of(session)}
        topics = {
            row.source: tuple(f"/{topic.name}" for topic in row.topics)
            for row in table.SENSORS
            if row.options is None
        } | {BATTERY: tuple(each.name for each in ENERGY)}
        self._topics = {read: names for read, names in topics.items() if heard.issuperset(names)}
        self.fed = {topic: 0 for topics in self._topics.values() for topic in topics}
        self.diagnostics: Diagnostics | None = None

    def take(self, sample: Sample) -> None:
        """Takes a sample; one that no column is made of is left out."""
        remark, topics = self._hand_on(sample), self._topics.get(source(sample), ())
        for topic in topics:
            self.fed[topic] += 1
            if self.diagnostics is not None:
                self.diagnostics.arrived(topic, sample.stamp_ns, remark)

    def _hand_on(self, sample: Sample) -> Remark | None:
        """What is odd about a sample that the session has taken."""
        session, remark = self._session, None
        match sample:
            case LaserScan():
                remark = session.take_scan(sample.stamp_ns, sample.ranges, angles=self._angles)
            case Imu(stamp_ns, orientation, angular_velocity, linear_acceleration):
                remark = session.take_imu(stamp_ns, linear_acceleration, angular_velocity, orientation)
            case Pose():
                remark = session.take_pose(sample.stamp_ns, None if sample.empty else sample.position)
            case Odometry():
                remark = session.take_odometry(sample.stamp_ns, (sample.twist.linear, 0.0, 0.0))
            case GroundTruth():
                session.take_true_velocity(sample.linear_velocity)
            case Battery() if sample.sensor == BATTERY:
                session.take_battery(sample.stamp_ns, sample.voltage, sample.current)
            case TruthState():
                session.take_contact(touches=sample.hazard_contact)
                session.take_traversal(sample.traversal)
        return remark
