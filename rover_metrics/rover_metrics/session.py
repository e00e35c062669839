"""The door to the metrics: samples in, rows out.

Node, replay, runs without ROS and tuning hand their samples to a MetricsSession and use nothing below
it. Vectors are tuples in SI units, stamps nanoseconds; frames are those of the ROS messages.
"""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from numpy.typing import ArrayLike

from rover_metrics.core.columns import COLUMNS, Row
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.core.rotation import Quaternion, Vector3
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, Thresholds
from rover_metrics.extended.metrics import ExtendedMetrics
from rover_metrics.extended.settings import ExtendedSettings
from rover_metrics.health import rejections
from rover_metrics.timing import NANOSECONDS


class Remark(NamedTuple):
    """What is odd about a sample, by its name in counts, and whether it was left out of the metrics."""

    finding: str
    left_out: bool = True


class MetricsSession:
    """One session: the twelve columns, and the extended ones if there are settings for them.

    Each take method returns what is odd about its sample, None if nothing is.

    Args:
        thresholds: What counts as an event; `metrics.thresholds` replaces them.
        settings: Settings of the extended columns; None leaves these out.

    Attributes:
        metrics: The twelve columns.
        extended: The extended ones; None without.
    """

    def __init__(
        self, thresholds: Thresholds = DEFAULT_THRESHOLDS, settings: ExtendedSettings | None = None
    ) -> None:
        self.metrics = TraversalMetrics(thresholds)
        self.extended = None if settings is None else ExtendedMetrics(self.metrics, settings)

    @property
    def columns(self) -> tuple[str, ...]:
        """Returns the header of the rows."""
        return COLUMNS if self.extended is None else self.extended.header

    def take_scan(
        self,
        stamp_ns: int,
        ranges: ArrayLike,
        *,
        angles: tuple[float, float],
        limits: tuple[float, float] = (0.0, math.inf),
    ) -> Remark | None:
        """Takes a lidar scan; one without a finite range is open space, not a fault.

        Args:
            stamp_ns: Stamp of the header [ns].
            ranges: Distances [m], coded as REP-117 says.
            angles: Azimuth of the first beam and step to the next, in the lidar's frame [rad].
            limits: Between which the lidar can measure [m].
        """
        metrics = self.metrics
        used = metrics.add_scan(ranges)
        if self.extended is not None:
            self.extended.add_scan(stamp_ns, ranges, angles, used=used)
        if used:
            oddity = rejections.scan_oddity(metrics.clearance, metrics.farthest, *limits)
        else:
            oddity = rejections.unusable_scan(ranges)
        return None if oddity is None else Remark(oddity, left_out=False)

    def take_imu(
        self,
        stamp_ns: int,
        acceleration: Vector3,
        angular_velocity: Vector3,
        orientation: Quaternion | None = None,
    ) -> Remark | None:
        """Takes an IMU sample.

        Args:
            stamp_ns: Stamp of the header [ns].
            acceleration: In the IMU's frame, gravity included [m/s^2].
            angular_velocity: In the same frame [rad/s].
            orientation: Attitude of the IMU as (x, y, z, w); None if the sensor does not give it.
        """
        used = self.metrics.add_imu(acceleration, angular_velocity)
        if self.extended is not None:
            self.extended.add_imu(stamp_ns, acceleration, orientation, used=used)
        return None if used else Remark(rejections.imu_fault(acceleration, angular_velocity))

    def take_pose(self, stamp_ns: int, position: Vector3 | None) -> Remark | None:
        """Takes a true position in the world [m]; None stands for an array without one."""
        metrics = self.metrics
        used = position is not None and metrics.add_pose(position)
        if self.extended is not None:
            self.extended.add_pose(stamp_ns, position, used=used)
        if not used:
            return Remark(rejections.NO_POSE if position is None else rejections.NOT_FINITE)
        if metrics.last_step >= metrics.thresholds.distance_threshold:
            return Remark(rejections.JUMPED, left_out=False)
        return None

    def take_odometry(self, stamp_ns: int, velocity: Vector3) -> Remark | None:
        """Takes the linear velocity that the wheels tell, in the base frame [m/s]."""
        used = self.metrics.add_odometry(velocity)
        if self.extended is not None:
            self.extended.add_odometry(stamp_ns, velocity, used=used)
        return None if used else Remark(rejections.odometry_fault(velocity))

    def take_true_velocity(self, velocity: Vector3) -> Remark | None:
        """Takes the true linear velocity in the base frame [m/s]."""
        return self._judged(self.extended is None or self.extended.truth.add_velocity(velocity))

    def take_contact(self, *, touches: bool) -> Remark | None:
        """Takes whether the rover has touched a hazard since the last time, from the truth."""
        if self.extended is not None:
            self.extended.truth.add_contact(touches=touches)
        return None

    def take_traversal(
        self, values: Sequence[float], names: Sequence[str] | None = None
    ) -> Remark | None:
        """Takes the other values of the truth, with their names if the message has any."""
        return self._judged(self.extended is None or self.extended.truth.add_traversal(values, names))

    def take_battery(self, stamp_ns: int, voltage: float, current: float) -> Remark | None:
        """Takes a state of the battery.

        Args:
            stamp_ns: Stamp of the header [ns].
            voltage: Of the battery [V].
            current: Negative while it discharges [A].
        """
        if not (math.isfinite(voltage) and math.isfinite(current)):
            return self._judged(False)
        if self.extended is not None and self.extended.energy is not None:
            self.extended.energy.add(stamp_ns, voltage, current)
        return None

    def row(self, now_ns: int, reported_lost: Mapping[str, int] = MappingProxyType({})) -> Row:
        """Returns the row at a ROS time [ns]; the middleware reports what it has lost, by topic."""
        if self.extended is None:
            return self.metrics.row(now_ns // NANOSECONDS)
        return self.extended.row(now_ns, reported_lost)

    @staticmethod
    def _judged(used: bool) -> Remark | None:
        return None if used else Remark(rejections.NOT_FINITE_OR_OTHER)
