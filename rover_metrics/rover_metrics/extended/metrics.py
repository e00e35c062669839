"""Extended metrics: the samples that TraversalMetrics has judged in, an extended row out."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from numpy.typing import ArrayLike

from rover_metrics.core.metrics import TraversalMetrics, Vector3
from rover_metrics.extended.imu_columns import ImuColumns, Quaternion
from rover_metrics.extended.row import ExtendedRow
from rover_metrics.extended.scan_columns import ScanColumns
from rover_metrics.extended.settings import ExtendedSettings
from rover_metrics.extended.traffic_columns import IMU, ODOMETRY, POSE, SCAN, Topic, TrafficColumns
from rover_metrics.extended.travel_columns import TravelColumns
from rover_metrics.extended.truth_columns import TRAVERSAL, TruthColumns
from rover_metrics.timing.clocks import NANOSECONDS

NONE_LOST: Mapping[Topic, int] = MappingProxyType({})


class ExtendedMetrics:
    """The extended columns of one session.

    Each add method takes a sample after `metrics` has, with the stamp of its header [ns] and whether
    `metrics` has used it.

    Args:
        metrics: The twelve columns of the same session, and the thresholds.
        settings: Of the extended columns; `use` replaces them.
    """

    def __init__(self, metrics: TraversalMetrics, settings: ExtendedSettings) -> None:
        self._metrics = metrics
        self._travel = TravelColumns()
        self._scans = ScanColumns(settings)
        self._imu = ImuColumns(settings.gravity)
        self._traffic = TrafficColumns()
        self._truth = TruthColumns()

    def use(self, settings: ExtendedSettings) -> None:
        """Measure by other settings from now on."""
        self._scans.use(settings)
        self._imu.gravity = settings.gravity

    def add_scan(
        self,
        stamp_ns: int,
        ranges: ArrayLike,
        *,
        angle_min: float,
        angle_increment: float,
        used: bool,
    ) -> None:
        """Take a scan; one without a finite range is open space, not a fault."""
        self._traffic.add(SCAN, stamp_ns, used=True)
        metrics = self._metrics
        self._scans.add(
            stamp_ns,
            ranges,
            angle_min=angle_min,
            angle_increment=angle_increment,
            collides=used and metrics.clearance < metrics.thresholds.collision_threshold,
        )

    def add_imu(
        self, stamp_ns: int, acceleration: Vector3, orientation: Quaternion | None, *, used: bool
    ) -> None:
        """Take an IMU sample; None for an orientation that the sensor does not give."""
        self._traffic.add(IMU, stamp_ns, used=used)
        if used:
            self._imu.add(stamp_ns, acceleration, orientation)
            threshold = self._metrics.thresholds.rough_terrain_threshold
            self._travel.add_imu(stamp_ns, is_rough=math.hypot(*acceleration) > threshold)

    def add_pose(self, stamp_ns: int, position: Vector3 | None, *, used: bool) -> None:
        """Take a position; None for an array without one."""
        self._traffic.add(POSE, stamp_ns, used=used)
        if used and position is not None:
            self._travel.add_pose(stamp_ns, position, self._metrics.thresholds.distance_threshold)

    def add_odometry(self, stamp_ns: int, velocity: Vector3, *, used: bool) -> None:
        """Take a wheel odometry sample."""
        self._traffic.add(ODOMETRY, stamp_ns, used=used)
        if used:
            self._travel.add_odometry(stamp_ns, math.hypot(*velocity))

    def add_contact(self, *, touches: bool) -> None:
        """Take from the truth whether the rover touches a hazard."""
        self._truth.add_contact(touches=touches)

    def add_true_velocity(self, velocity: Vector3) -> bool:
        """Take the true velocity [m/s]; tells whether it was usable."""
        return self._truth.add_velocity(velocity)

    def add_traversal(self, values: Sequence[float], names: Sequence[str] = TRAVERSAL) -> bool:
        """Take the values of the truth and their names; tells whether they were usable."""
        return self._truth.add_traversal(values, names)

    def row(self, now_ns: int, reported_lost: Mapping[Topic, int] = NONE_LOST) -> ExtendedRow:
        """Sum up the session so far, and what there was since the row before.

        Args:
            now_ns: ROS time of the row [ns].
            reported_lost: Messages that the middleware says it has lost, by topic.
        """
        cells = (
            *self._travel.cells(),
            *self._scans.cells(),
            *self._imu.cells(),
            *self._traffic.cells(now_ns, reported_lost),
            *self._truth.cells(),
        )
        return ExtendedRow(self._metrics.row(now_ns // NANOSECONDS), cells)
