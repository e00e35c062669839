"""What an entry knows and commands: the samples that listeners get, as a node hears them over topics.

Faults have acted on them. A driver of this process and a node of another one therefore know the same.
"""

import math

from harness.drivers.base import Driver, Observation, TakesGoals, drivable
from harness.episode.batch import Batch
from harness.episode.episode import Episode
from harness.samples import GoalPose, LaserScan, Pose, Sample, Tick, source
from rover_metrics.core import rotation


class Client:
    """Drives an episode by a driver that hears what is published: a sink, and an observer of batches."""

    def __init__(self, driver: Driver, episode: Episode) -> None:
        self._driver, self._episode = driver, episode
        self._rover = episode.simulation.scene.rover
        self._readings: dict[type[Sample], Sample] = {}

    def hear(self, _: Tick, sent: Tick) -> None:
        """Takes the samples that faults leave of a tick; the last pose that says where it is holds."""
        for sample in sent.samples:
            if isinstance(sample, GoalPose) and isinstance(self._driver, TakesGoals):
                x, y, _height = sample.position
                self._driver.head_for(x, y, rotation.yaw(sample.orientation))
            is_lost = isinstance(sample, Pose) and (
                sample.empty or not all(map(math.isfinite, sample.position))
            )
            if isinstance(source(sample), type) and not is_lost:
                self._readings[type(sample)] = sample

    def take(self, batch: Batch) -> None:
        """Commands the next control period."""
        pose, scan = self._readings.get(Pose), self._readings.get(LaserScan)
        if not isinstance(pose, Pose):
            return
        x, y, _ = pose.position
        ranges = scan.ranges if isinstance(scan, LaserScan) else None
        yaw = rotation.yaw(pose.orientation)
        observation = Observation(batch.truth.time_ns, x, y, yaw, ranges, readings=self._readings)
        self._episode.command(drivable(self._driver.command(observation), self._rover))
