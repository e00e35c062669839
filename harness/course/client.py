"""What an entry knows and commands: the samples that listeners get, as a node hears them over topics.

Faults have acted on them. A driver of this process and a node of another one therefore know the same.
"""

import math

from harness.course.referee import Referee
from harness.drivers.base import Driver, Observation, TakesGoals, drivable
from harness.episode.batch import Batch
from harness.episode.episode import Episode
from harness.samples import LaserScan, Pose, Sample, Tick, source
from rover_metrics.core import rotation


class Client:
    """Drives an episode by a driver that hears what is published: a sink, and an observer of batches.

    Args:
        driver: Who chooses the commands.
        episode: Obeys them.
        referee: Says which goal is next.
    """

    def __init__(self, driver: Driver, episode: Episode, referee: Referee) -> None:
        self._driver, self._episode, self._referee = driver, episode, referee
        self._rover = episode.simulation.scene.rover
        self._readings: dict[type[Sample], Sample] = {}
        self._goals_told = -1
        self._pose: Pose | None = None
        self._steer(0)

    def hear(self, _: Tick, sent: Tick) -> None:
        """Takes the samples that faults leave of a tick."""
        for sample in sent.samples:
            if isinstance(sample, Pose):
                if not sample.empty and all(map(math.isfinite, sample.position)):
                    self._pose = sample
            elif isinstance(source(sample), type):
                self._readings[type(sample)] = sample
        if self._pose is not None:
            self._readings[Pose] = self._pose

    def take(self, batch: Batch) -> None:
        """Commands the next control period."""
        if not self._referee.ending:
            self._steer(batch.truth.time_ns)

    def _steer(self, time_ns: int) -> None:
        goal, driver = self._referee.goal, self._driver
        if (
            goal is not None
            and self._goals_told < self._referee.goals
            and isinstance(driver, TakesGoals)
        ):
            driver.head_for(*goal, 0.0)
            self._goals_told = self._referee.goals
        if self._pose is None:
            return
        x, y, _ = self._pose.position
        scan = self._readings.get(LaserScan)
        ranges = scan.ranges if isinstance(scan, LaserScan) else None
        yaw = rotation.yaw(self._pose.orientation)
        observation = Observation(time_ns, x, y, yaw, ranges, readings=self._readings)
        self._episode.command(drivable(driver.command(observation), self._rover))
