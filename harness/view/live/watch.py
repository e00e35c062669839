"""What there is to see of a rover now: an observer that keeps the latest of everything."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.samples import ActorPoses, JointStates, LaserScan, Pose, Truth, TruthState, Vector3
from harness.view.states import people_row
from rover_metrics.core.columns import Row

Ranges = NDArray[np.float32]

PATH_STEP = 0.05  # [m] between two points of a path
MOST_ROWS = 2000  # of charts: then every other one is left out
MOST_POINTS = 4000  # of a path: then every other one is left out


class Sight(NamedTuple):
    """What is seen of a rover at a moment.

    Attributes:
        position: Of its model frame [m]; its attitude is `wxyz`.
        joints: Positions of its joints, in their order.
    """

    position: Vector3
    wxyz: tuple[float, float, float, float]
    joints: tuple[float, ...]


class Watch:
    """Keeps the latest of one rover, for another thread to look at at any time.

    Args:
        row: Returns the latest row of the rover's log; None before the first.

    Attributes:
        rows: Of the log.
        sight: The latest; None before the first.
        truth: Of the same batch; `speed` is the true one forwards [m/s].
        ranges: Of the latest scan, as LaserScan has them.
        people: x, y, z [m] and heading [rad] of each person, shape (people, 4).
        path: Where it has been [m].
        version: Changes with all of that.
    """

    def __init__(self, row: Callable[[], Row | None] = lambda: None) -> None:
        self._row = row
        self.rows: list[Row] = []
        self.sight: Sight | None = None
        self.truth, self.speed = Truth(), 0.0
        self.ranges: Ranges | None = None
        self.people = np.zeros((0, 4))
        self.path: list[Vector3] = []
        self.version = 0
        self._step = PATH_STEP

    @property
    def time_s(self) -> float:
        """Simulated time of the latest [s]."""
        return self.truth.time_ns / NANOSECONDS

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        for tick in batch.ticks:
            pose, joints = tick.of(Pose), tick.of(JointStates)
            if pose is not None and joints is not None:
                x, y, z, w = pose.orientation
                self.sight = Sight(pose.position, (w, x, y, z), joints.position)
                self._go_on(pose.position)
            if scan := tick.of(LaserScan):
                self.ranges = scan.ranges
            if truth := tick.of(TruthState):
                self.speed = truth.speed
            if people := tick.of(ActorPoses):
                self.people = np.array(people_row(people)).reshape(-1, 4)
        row = self._row()
        if row is not None and (not self.rows or row is not self.rows[-1]):
            self.rows = [*(self.rows[::2] if len(self.rows) >= MOST_ROWS else self.rows), row]
        self.truth = batch.truth
        self.version += 1

    def see(self, sight: Sight | None, truth: Truth, ranges: Ranges | None) -> None:
        """Takes the state of a rover that is in no batch.

        Args:
            sight: Its pose and joints; None to keep those before.
            truth: What the simulator knows of it.
            ranges: Of its lidar [m]; None without a scan.
        """
        self.truth, self.ranges = truth, ranges
        if sight is not None:
            self.sight = sight
            self._go_on(sight.position)
        self.version += 1

    def _go_on(self, place: Vector3) -> None:
        if self.path and math.dist(self.path[-1], place) < self._step:
            return
        self.path.append(place)
        if len(self.path) > MOST_POINTS:
            self.path, self._step = self.path[::2], 2 * self._step
