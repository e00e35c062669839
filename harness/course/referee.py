"""Watches an episode and says when it is over and how it went: an observer of its batches."""

import math
from dataclasses import dataclass

import numpy as np

from harness.base.sim_time import NANOSECONDS
from harness.course.planner import RESOLUTION
from harness.course.task import Point, Task
from harness.episode.assembly import route_progress
from harness.episode.batch import Batch
from harness.samples import ActorPoses, JointStates, Pose, Truth
from harness.world.actors.free_space import FreeSpace
from harness.world.world import World
from rover_metrics.core import rotation

ENDINGS = REACHED, CONTACT, TIPPED, LATE = "reached", "contact", "tipped", "time"
RISK_DISTANCE = 0.5  # [m], RoboTerrain's, from the rover's middle to the nearest hazard or person
SAME_PLACE = RESOLUTION  # [m] the rover moves between two looks for hazards


@dataclass(frozen=True)
class Drive:
    """What an episode came to, unrounded: fields of an EpisodeResult, and the totals of the drive."""

    ending: str
    goals: int
    time: float
    energy: float
    risk_s: float
    tilt_p95: float
    truth: Truth


class Referee:
    """Takes the batches of an episode, a task in its world, until it is over.

    Attributes:
        ending: Why the episode is over; "" while it goes on.
    """

    def __init__(self, task: Task, world: World) -> None:
        self._task, self._space = task, FreeSpace(world.ground, world.obstacles)
        self._radii = [person.spec.options.radius for person in world.people]
        self.ending, self._progress = "", route_progress(task.run, world)
        self._truth, self._began_ns = Truth(), 0 if task.rule.begins_at == 0.0 else None
        start = world.start[:2]
        self._start: Point = (start[0], start[1])
        self._energy, self._joints_ns = 0.0, 0
        self._risk_batches, self._looked_at, self._is_near = 0, (math.inf, math.inf), False
        self._people: ActorPoses | None = None
        self._tilts: list[float] = []
        self._before_ns = self._period_ns = 0

    def take(self, batch: Batch) -> None:
        """Takes the next batch, unless it is over."""
        if self.ending:
            return
        self._truth, time_ns = batch.truth, batch.truth.time_ns
        self._period_ns, self._before_ns = time_ns - self._before_ns, time_ns
        self._sense(batch)
        x, y, _ = batch.truth.position
        if self._began_ns is None and math.dist(self._start, (x, y)) >= self._task.rule.begins_at:
            self._began_ns = time_ns
        self._risk_batches += self._is_at_risk(x, y)
        self._progress.observe(time_ns / NANOSECONDS, (x, y))
        self.ending = self._ending()

    def drive(self, failure: str = "") -> Drive:
        """Returns what the episode came to; `failure` is why it ended before the referee ended it."""
        ending = self.ending or failure or LATE
        tilts = np.sort(np.array(self._tilts or [0.0]))
        return Drive(
            ending=ending,
            goals=len(self._progress.reached),
            time=self._time,
            energy=self._energy,
            risk_s=self._risk_batches * self._period_ns / NANOSECONDS,
            tilt_p95=float(tilts[math.ceil(0.95 * len(tilts)) - 1]),
            truth=self._truth,
        )

    @property
    def _time(self) -> float:
        if self._began_ns is None:
            return 0.0
        return (self._truth.time_ns - self._began_ns) / NANOSECONDS

    def _ending(self) -> str:
        rule = self._task.rule
        if rule.touch_ends and self._truth.hazard_contact_s > 0.0:
            return CONTACT
        if self._truth.tipped_over:
            return TIPPED
        if not math.isnan(self._progress.done_s):
            return REACHED
        return LATE if self._time >= rule.limit else ""

    def _sense(self, batch: Batch) -> None:
        """Sums up energy and tilt."""
        for tick in batch.ticks:
            if (joints := tick.of(JointStates)) is not None:
                turning = zip(joints.effort, joints.velocity, strict=True)
                power = math.fsum(abs(effort * speed) for effort, speed in turning)
                self._energy += power * (joints.stamp_ns - self._joints_ns) / NANOSECONDS
                self._joints_ns = joints.stamp_ns
            if (pose := tick.of(Pose)) is not None:
                self._tilts.append(rotation.tilt(pose.orientation))
            self._people = tick.of(ActorPoses) or self._people

    def _is_at_risk(self, x: float, y: float) -> bool:
        """Whether a hazard or a person is near; hazards are looked for where the rover has moved."""
        if math.dist(self._looked_at, (x, y)) > SAME_PLACE:
            self._looked_at = (x, y)
            near = self._space.blocked(np.array([[x, y]]), RISK_DISTANCE)
            self._is_near = near is not None
        people = () if self._people is None else zip(self._people.position, self._radii, strict=True)
        return self._is_near or any(
            math.dist(place[:2], (x, y)) - radius < RISK_DISTANCE for place, radius in people
        )
