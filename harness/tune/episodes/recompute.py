"""The samples of an episode that tuning looks at -> rows: a scan's extrema, a second's extrema."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.episode.metrics_feed import extended_settings
from harness.robots import RoverSpec
from harness.samples import Imu, LaserScan, PlacedScan, Pose, Sample, TruthState
from harness.sensors.lidar_spec import LidarSpec
from harness.truth.traversal import ContactEvent
from harness.tune.episodes.record import SCAN, WINDOW, Table
from rover_metrics.extended.footprint import Footprint, FootprintClearance

STRIDE = 5  # poses from one to the next if four between them are lost

S = TypeVar("S", bound=Sample)
Series = NDArray[np.float64]  # shape (n, 1 + k): time [s] and k values


@dataclass
class Collected:
    """Lists in order of time; `states` are as many as `scans`, each of the same tick."""

    scans: list[LaserScan] = field(default_factory=list)
    states: list[TruthState] = field(default_factory=list)
    imu: list[Imu] = field(default_factory=list)
    poses: list[Pose] = field(default_factory=list)
    events: list[ContactEvent] = field(default_factory=list)

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        for sample in (sample for tick in batch.ticks for sample in tick.samples):
            match sample:
                case LaserScan():
                    self.scans.append(sample)
                case TruthState():
                    self.states.append(sample)
                case Imu():
                    self.imu.append(sample)
                case Pose():
                    self.poses.append(sample)
        self.events += batch.events

    @property
    def path_length(self) -> float:
        """True path [m]."""
        return self.states[-1].path_length if self.states else 0.0

    def placed_scans(self) -> list[PlacedScan]:
        """Returns each scan with the pose nearest to it in time, at most 10 ms away."""
        stamps = np.array([pose.stamp_ns for pose in self.poses])
        halfway = (stamps[1:] + stamps[:-1]) / 2
        nearest = np.searchsorted(halfway, [scan.stamp_ns for scan in self.scans])
        return [PlacedScan(scan, self.poses[at]) for scan, at in zip(self.scans, nearest, strict=True)]


def scan_rows(collected: Collected, rover: RoverSpec) -> Table:
    """Returns one row of dtype SCAN per scan."""
    rows = np.zeros(len(collected.scans), SCAN)
    if not collected.scans:
        return rows
    settings = extended_settings(rover)
    angles = LidarSpec(beams=len(collected.scans[0].ranges)).angles
    clearance = FootprintClearance(Footprint.rectangle(rover.footprint), settings.lidar_pose, angles)
    for row, scan, state in zip(rows, collected.scans, collected.states, strict=True):
        row["stamp_ms"] = scan.stamp_ns // 1_000_000
        row["nearest"] = np.min(scan.ranges, initial=np.inf, where=np.isfinite(scan.ranges))
        row["near_returns"] = np.count_nonzero(np.isneginf(scan.ranges))
        row["footprint"] = clearance.nearest(scan.ranges)
        row["contact"], row["speed"] = state.hazard_contact, state.speed
    return rows


def window_rows(collected: Collected) -> Table:
    """Returns one row of dtype WINDOW per full second."""
    imu = _series(collected.imu, _felt, 2)
    states = _series(
        collected.states, lambda s: (s.speed, s.roughness, s.rock_contact, s.hazard_contact), 4
    )
    poses = _series(collected.poses, lambda pose: pose.position, 3)
    steps, strides = _distances(poses, 1), _distances(poses, STRIDE)
    seconds = int(states[-1, 0]) if len(states) else 0
    rows = np.zeros(seconds, WINDOW)
    for second, row in enumerate(rows):
        acceleration, smoothness = _within(imu, second).T
        speed, roughness, rocks, contact = _within(states, second).T
        row["time_s"] = second + 1
        row["peak_acceleration"] = acceleration.max()
        row["mean_smoothness"], row["peak_smoothness"] = smoothness.mean(), smoothness.max()
        row["speed"], row["roughness"] = np.abs(speed).mean(), roughness.mean()
        row["rocks"], row["contact"] = rocks.mean(), contact.any()
        row["largest_step"] = _within(steps, second).max(initial=0.0)
        row["largest_stride"] = _within(strides, second).max(initial=0.0)
        row["from_start"] = np.linalg.norm(_within(poses, second)[-1] - poses[0, 1:])
    return rows


def _within(series: Series, second: int) -> NDArray[np.float64]:
    """The values of (second, second + 1], shape (m, k)."""
    first, last = np.searchsorted(series[:, 0], (second, second + 1), side="right")
    return series[first:last, 1:]


def _felt(sample: Imu) -> tuple[float, float]:
    acceleration = math.hypot(*sample.linear_acceleration)
    return acceleration, acceleration + math.hypot(*sample.angular_velocity)


def _series(samples: Sequence[S], values: Callable[[S], Sequence[float]], width: int) -> Series:
    rows = [(sample.stamp_ns / NANOSECONDS, *values(sample)) for sample in samples]
    return np.array(rows, dtype=np.float64).reshape(-1, 1 + width)


def _distances(poses: Series, stride: int) -> Series:
    """From each pose to the one `stride` later, stamped as that one."""
    distances = np.linalg.norm(poses[stride:, 1:] - poses[:-stride, 1:], axis=1)
    return np.column_stack([poses[stride:, 0], distances])
