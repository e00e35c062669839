"""One episode of an entry: the project's own loop, a client that commands, a referee that watches."""

import math
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

import numpy as np

from harness.base.errors import RunFailed
from harness.base.streams import EPISODE, seeded
from harness.course.entry import Entry, unpack
from harness.course.referee import Referee
from harness.course.result import EpisodeResult, result_of
from harness.course.task import Case, Task
from harness.course.tracks import find_track
from harness.drivers import find_driver
from harness.drivers.base import Driver, DriverContext, Observation, TakesGoals, commanded, drivable
from harness.drivers.policy import PolicyDriver, read_policy
from harness.episode.assembly import injector
from harness.episode.batch import Batch
from harness.episode.episode import Episode
from harness.episode.loop import Route, drive
from harness.episode.together import Together
from harness.robots.lidar import LidarSpec
from harness.samples import ActorPoses, GoalPose, JointStates, LaserScan, Pose, Sample, Tick, source
from rover_metrics.core import rotation

D = TypeVar("D", bound=Driver)
MEASURED: frozenset[type[Sample]] = frozenset((Pose, JointStates, ActorPoses))


def attempt(case: Case, *, entry: Entry) -> EpisodeResult:
    """Drives an episode and returns how it went; UsageError if entry or world are not valid."""
    with TemporaryDirectory(prefix="rover-course-") as scratch:
        folder = Path(scratch)
        unpack(entry, folder)
        task = find_track(case.track).task(case, folder)
        if entry.about is not None and entry.about.launch:
            from harness.course.node_entry import drive_node  # noqa: PLC0415 - only this needs ROS 2

            return drive_node(case, task, entry.about, folder)
        kind = find_driver(entry.driver(case.track, folder))
        return _driven(case, _seen_by(kind, task), kind)[0]


def drive_with(case: Case, kind: type[D]) -> tuple[EpisodeResult, D]:
    """Returns how an episode goes with a driver of Python, and that driver: to look at, and to learn."""
    with TemporaryDirectory(prefix="rover-course-") as scratch:
        return _driven(case, find_track(case.track).task(case, Path(scratch)), kind)


def _seen_by(kind: type[Driver], task: Task) -> Task:
    """The task with the lidar that a policy was made for; any other driver takes the track's."""
    if not issubclass(kind, PolicyDriver):
        return task
    return replace(task, run=task.run.alone(lidar_beams=read_policy(kind.file).beams))


def _driven(case: Case, task: Task, kind: type[D]) -> tuple[EpisodeResult, D]:
    episode = Episode(task.run, samples=MEASURED | kind.senses)
    scene = episode.simulation.scene
    referee = Referee(task, scene.world)
    driver = kind(_context(episode))
    client = Client(driver, episode)
    route = Route(injector(task.run), client.hear, (referee, client))
    failure = ""
    try:
        for _ in drive(Together((episode,)).batches(), (route,)):
            if referee.ending:
                break
    except RunFailed as error:
        failure = str(error)
    return result_of(case, task, referee.drive(failure), episode), driver


def _context(episode: Episode) -> DriverContext:
    """What a driver is made for: the rover and its lidar, without the world's obstacles."""
    scene, run = episode.simulation.scene, episode.run
    middle, half_size = scene.world.roaming
    bearings = LidarSpec(beams=run.rover.lidar_beams).bearings(scene.rover.lidar_yaw)
    rng = np.random.default_rng(seeded(run.seed, EPISODE).spawn(1)[0])
    return DriverContext(scene.rover, half_size, bearings, rng, middle=middle)


class Client:
    """Drives an episode by a driver that hears what is published: a sink, and an observer of batches.

    Faults have acted on it: a driver of this process and a node of another one know the same.
    """

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
        self._episode.command(drivable(commanded(self._driver, observation), self._rover))
