"""The samples of an episode that tuning looks at, sorted by kind."""

from dataclasses import dataclass, field

import numpy as np

from harness.episode.batch import Batch
from harness.samples import Imu, LaserScan, PlacedScan, Pose, TruthState
from harness.truth.events import ContactEvent


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
        for tick in batch.ticks:
            for sample in tick.samples:
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
        """Each scan with the pose nearest to it in time, at most 10 ms away."""
        stamps = np.array([pose.stamp_ns for pose in self.poses])
        halfway = (stamps[1:] + stamps[:-1]) / 2
        nearest = np.searchsorted(halfway, [scan.stamp_ns for scan in self.scans])
        return [
            PlacedScan(scan, self.poses[index])
            for scan, index in zip(self.scans, nearest.tolist(), strict=True)
        ]
