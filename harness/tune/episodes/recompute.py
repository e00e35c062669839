"""An episode as rows: what a MetricsSession and the truth say of it, by scan, second and contact.

A contact with a hazard has its place on the rover, and whether the lidar could have known.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.episode.metrics_feed import SampleFeed, extended_settings
from harness.robots import RoverSpec
from harness.robots.lidar import LidarSpec, scan_points
from harness.samples import (
    ContactEvent,
    Imu,
    LaserScan,
    PlacedScan,
    Pose,
    Sample,
    Tick,
    TruthState,
    Vector3,
)
from harness.tune.episodes.record import EVENT, SCAN, WINDOW, Sight, Table, Zone
from harness.world.obstacles import Obstacle
from harness.world.world import World
from rover_metrics.session import MetricsSession

STRIDE = 5  # poses from one to the next if four between them are lost
FOOTPRINT = "Footprint Clearance [m]"  # an extended column: of the scans since the row before
BEFORE_NS, AFTER_NS = 500_000_000, 200_000_000  # around its start: when the hazard should be in sight
NEAR = 0.1  # [m] from the outline within which a return is one of the hazard
BELOW = 0.02  # [m] by which a top must reach above the lidar's plane to be seen for sure


class Collected:
    """Observes an episode: keeps its samples, and what the metrics say at each scan and IMU sample.

    Attributes:
        scans: Every scan in order of time, as are `poses`.
        events: Contacts that have ended.
        path_length: True path [m].
        tipped_over: Whether the rover lies on its side.
    """

    def __init__(self, rover: RoverSpec, lidar: LidarSpec | None = None) -> None:
        self.scans: list[LaserScan] = []
        self.poses: list[Pose] = []
        self.events: list[ContactEvent] = []
        self.path_length, self.tipped_over = 0.0, False
        self._session = MetricsSession(settings=extended_settings(rover))
        self._feed = SampleFeed(self._session, lidar or LidarSpec())
        self._scan_rows: list[tuple[float, ...]] = []
        self._imu: list[tuple[float, ...]] = []  # time, |a|, the sum of |a| + |w| up to then
        self._states: list[tuple[float, ...]] = []
        self._steps: list[tuple[float, ...]] = []

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        for tick in batch.ticks:
            self._take(tick)
        self.events += batch.events
        self.tipped_over = batch.truth.tipped_over

    def _take(self, tick: Tick) -> None:
        time, metrics = tick.stamp_ns / NANOSECONDS, self._session.metrics
        by_type: dict[type[Sample], Sample] = {}
        for sample in tick.samples:
            self._feed.take(sample)
            by_type[type(sample)] = sample
            if isinstance(sample, Pose):
                self._steps.append((time, metrics.last_step))
                self.poses.append(sample)
            elif isinstance(sample, TruthState):
                truth = (sample.speed, sample.roughness, sample.rock_contact, sample.hazard_contact)
                self._states.append((time, *truth))
                self.path_length = sample.path_length
        scan = by_type.get(LaserScan)
        if scan is None and Imu not in by_type:
            return
        row = self._session.row(tick.stamp_ns)
        if Imu in by_type:
            self._imu.append((time, row.imu_acceleration_magnitude, row.smoothness_metric))
        if isinstance(scan, LaserScan):
            self.scans.append(scan)
            footprint = float(row.extended[FOOTPRINT] or 0.0)
            # A scan without a finite range leaves the metrics' clearance as it was.
            nearest = metrics.clearance if math.isfinite(footprint) else math.inf
            near = float(np.count_nonzero(np.isneginf(scan.ranges)))
            _, speed, *_, contact = self._states[-1]
            stamp_ms = scan.stamp_ns // 1_000_000
            self._scan_rows.append((stamp_ms, nearest, near, footprint, contact, speed))

    def placed_scans(self) -> list[PlacedScan]:
        """Returns each scan with the pose nearest to it in time, at most 10 ms away."""
        stamps = np.array([pose.stamp_ns for pose in self.poses])
        halfway = (stamps[1:] + stamps[:-1]) / 2
        nearest = np.searchsorted(halfway, [scan.stamp_ns for scan in self.scans])
        return [PlacedScan(scan, self.poses[at]) for scan, at in zip(self.scans, nearest, strict=True)]

    def scan_rows(self) -> Table:
        """Returns one row of dtype SCAN per scan."""
        return np.array(self._scan_rows, SCAN)

    def window_rows(self) -> Table:
        """Returns one row of dtype WINDOW per full second."""
        kept = ((self._imu, 3), (self._states, 5), (self._steps, 2))
        imu, states, steps = (np.array(rows, float).reshape(-1, width) for rows, width in kept)
        positions = np.array([pose.position for pose in self.poses]).reshape(-1, 3)
        smoothness = np.diff(imu[:, 2], prepend=0.0)
        strides = np.linalg.norm(positions[STRIDE:] - positions[:-STRIDE], axis=1)
        rows = np.zeros(int(states[-1, 0]) if len(states) else 0, WINDOW)
        for second, row in enumerate(rows):
            felt, true, moved = (_within(series, second) for series in (imu, states, steps))
            row["time_s"] = second + 1
            row["peak_acceleration"] = imu[felt, 1].max()
            row["mean_smoothness"] = smoothness[felt].mean()
            row["peak_smoothness"] = smoothness[felt].max()
            row["speed"] = np.abs(states[true, 1]).mean()
            row["roughness"], row["rocks"] = states[true, 2:4].mean(axis=0)
            row["contact"] = states[true, 4].any()
            row["largest_step"] = steps[moved, 1].max(initial=0.0)
            row["largest_stride"] = strides[_within(steps[STRIDE:], second)].max(initial=0.0)
            row["from_start"] = np.linalg.norm(positions[moved][-1] - positions[0])
        return rows


def _within(series: NDArray[np.float64], second: int) -> slice:
    """Which rows are of (second, second + 1], by the time in their first column [s]."""
    return slice(*np.searchsorted(series[:, 0], (second, second + 1), side="right").tolist())


def event_rows(
    events: Sequence[ContactEvent],
    scans: Sequence[PlacedScan],
    speeds: NDArray[np.float16],
    world: World,
    rover: RoverSpec,
) -> Table:
    """Returns the contacts with hazards as a table of dtype EVENT.

    Args:
        events: All contacts of an episode.
        scans: Its scans in order.
        speeds: True forward speed at each of them [m/s], shape (n,).
        world: Where it took place.
        rover: That drove.
    """
    stamps = np.array([placed.scan.stamp_ns for placed in scans])
    hazards = [event for event in events if event.kind == "hazard"]
    rows = np.zeros(len(hazards), EVENT)
    for row, event in zip(rows, hazards, strict=True):
        around = event.start_ns - BEFORE_NS, event.start_ns + AFTER_NS
        first, last = np.searchsorted(stamps, around).tolist()
        before = max(int(np.searchsorted(stamps, event.start_ns)) - 1, 0)
        row["start_s"], row["end_s"] = event.start_ns / NANOSECONDS, event.end_ns / NANOSECONDS
        row["zone"] = zone(event.point, rover)
        touched = world.obstacles[int(event.other.rsplit("_", 1)[1])]
        row["sight"] = sight(scans[first:last], touched, rover)
        row["part"], row["force"] = event.part, event.force
        row["speed"] = speeds[before] if speeds.size else 0.0
    return rows


def zone(point: Vector3, rover: RoverSpec) -> Zone:
    """Returns the side of the rover nearest to a point of the model frame [m]."""
    x, y, _ = point
    x_min, x_max, y_min, y_max = rover.footprint
    sides = {Zone.FRONT: x_max - x, Zone.REAR: x - x_min, Zone.SIDE: min(y_max - y, y - y_min)}
    return min(sides, key=sides.__getitem__)


def sight(scans: Sequence[PlacedScan], hazard: Obstacle, rover: RoverSpec) -> Sight:
    """Returns what the scans around the start of a contact show of what was touched.

    Args:
        scans: In order, of the time around that start.
        hazard: That was touched.
        rover: That touched it.
    """
    if any(is_on(hazard, scan_points(placed, rover)).any() for placed in scans):
        return Sight.SEEN
    top = hazard.position[2] + hazard.half_size[-1]
    if scans and top < scans[-1].pose.position[2] + rover.lidar_height - BELOW:
        return Sight.TOO_LOW
    if any(np.isneginf(placed.scan.ranges).any() for placed in scans):
        return Sight.TOO_NEAR
    return Sight.MISSED


def is_on(hazard: Obstacle, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Returns which points [m], shape (n, 2), lie within or next to a hazard's outline: shape (n,)."""
    w, _, _, z = hazard.quaternion
    yaw = 2.0 * math.atan2(z, w)
    offset = points - hazard.position[:2]
    along = np.abs(offset @ (math.cos(yaw), math.sin(yaw)))
    across = np.abs(offset @ (-math.sin(yaw), math.cos(yaw)))
    half = hazard.half_size if hazard.shape != "cylinder" else hazard.half_size[:1] * 2
    return np.asarray((along < half[0] + NEAR) & (across < half[1] + NEAR))
