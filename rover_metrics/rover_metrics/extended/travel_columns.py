"""Columns of motion: speed over rough terrain, slip, efficiency of the path.

Samples of different topics are put together by their stamps, when a row is due: the order in which
they arrive within an instant is the middleware's.
"""

import math
from bisect import bisect_right
from collections import deque

from rover_metrics.core.columns import Cell, Column
from rover_metrics.core.rotation import Vector3

MOST_SAMPLES = 10_000  # of an interval; rows do not come while a clock stands still
SLOWEST_DRIVE = 0.05  # m/s: below it, standing or turning in place, a ratio of speeds says nothing
LONGEST_STEP = 1.0  # s
SHORTEST_PATH = 0.1  # m

_ODOMETRY = "/odometry/wheels twist.twist.linear"


class TravelColumns:
    """The columns that are computed from odometry and poses."""

    COLUMNS = (
        Column(
            name="VORT",
            unit="m/s",
            meaning="Velocity over rough terrain; empty where the terrain was not rough.",
            formula="Mean wheel speed since the row before, of the odometry samples whose latest IMU "
            "sample by stamp was rough (|a| > rough_terrain_threshold).",
            source=f"{_ODOMETRY}; /imu/data linear_acceleration",
            rate_invariant="of the odometry, yes; a faster IMU finds more, shorter rough moments",
        ),
        Column(
            name="Slip",
            meaning="Of the wheels while they drive: 0 none, towards 1 they spin, below 0 the rover "
            "outruns them; empty while they stand or turn it in place.",
            formula="(w - p) / max(w, p), w the mean wheel speed and p the pose's path over time "
            f"since the row before (two-sided, as Wong); empty while w is below {SLOWEST_DRIVE:g} m/s, "
            "where it is not defined. Steps of distance_threshold or more are left out.",
            source=f"{_ODOMETRY}; /rover/pose_array position",
            rate_invariant="yes, unless the pose is noisy: noise lengthens a path, and a fast one more",
        ),
        Column(
            name="Path Efficiency",
            meaning="How straight the way was: 1 a line, 0 back at the start.",
            formula="|sum of the steps| / sum of their lengths, since the start, steps of "
            f"distance_threshold or more left out; empty below {SHORTEST_PATH:g} m of path.",
            source="/rover/pose_array position",
            rate_invariant="yes, unless the pose is noisy: noise lengthens a path, and a fast one more",
        ),
    )

    def __init__(self) -> None:
        self._was_rough = False
        self._rough: deque[tuple[int, bool]] = deque(maxlen=MOST_SAMPLES)
        self._speeds: deque[tuple[int, float]] = deque(maxlen=MOST_SAMPLES)
        self._pose: tuple[int, Vector3] | None = None
        self._net, self._path = (0.0, 0.0, 0.0), 0.0
        self._stretch, self._stretch_s = 0.0, 0.0  # of the path since the row before

    def add_imu(self, stamp_ns: int, *, is_rough: bool) -> None:
        """Takes the verdict on an IMU sample that the metrics have used."""
        self._rough.append((stamp_ns, is_rough))

    def add_odometry(self, stamp_ns: int, speed: float) -> None:
        """Takes a wheel speed that the metrics have used [m/s]."""
        self._speeds.append((stamp_ns, speed))

    def add_pose(self, stamp_ns: int, position: Vector3, jump: float) -> None:
        """Takes a position that the metrics have used.

        Args:
            stamp_ns: Stamp of the header [ns].
            position: In the world [m].
            jump: From this length on a step is no travel [m].
        """
        last, self._pose = self._pose, (stamp_ns, position)
        if last is None:
            return
        length = math.dist(position, last[1])
        if length >= jump:
            return
        x, y, z = (n + b - a for n, a, b in zip(self._net, last[1], position, strict=True))
        self._net = (x, y, z)
        self._path += length
        step = (stamp_ns - last[0]) / 1e9
        if 0.0 < step <= LONGEST_STEP:
            self._stretch += length
            self._stretch_s += step

    def cells(self) -> tuple[Cell, ...]:
        """Returns the cells of a row; all but the efficiency begin anew."""
        cells = (self._vort(), self._slip(), self._efficiency())
        if self._rough:
            self._was_rough = max(self._rough)[1]
        self._rough.clear()
        self._speeds.clear()
        self._stretch = self._stretch_s = 0.0
        return cells

    def _vort(self) -> float | None:
        rough = sorted(self._rough)
        stamps = [stamp for stamp, _ in rough]
        verdicts = [self._was_rough, *(is_rough for _, is_rough in rough)]
        speeds = [speed for stamp, speed in self._speeds if verdicts[bisect_right(stamps, stamp)]]
        return math.fsum(speeds) / len(speeds) if speeds else None

    def _slip(self) -> float | None:
        if not self._speeds or self._stretch_s == 0.0:
            return None
        wheels = math.fsum(speed for _, speed in self._speeds) / len(self._speeds)
        if wheels < SLOWEST_DRIVE:
            return None
        pose = self._stretch / self._stretch_s
        return (wheels - pose) / max(wheels, pose)

    def _efficiency(self) -> float | None:
        return min(math.hypot(*self._net) / self._path, 1.0) if self._path >= SHORTEST_PATH else None
