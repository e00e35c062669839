"""Columns of the IMU: how rough the ride is without gravity, and how hard its jerks are."""

import math

from rover_metrics.core.columns import Cell, Column
from rover_metrics.core.rotation import Quaternion, Vector3, matrix

SETTLING = 1.0  # s: time constant of the gravity estimate where there is no orientation
LONGEST_STEP = 1.0  # s: samples further apart say nothing of what was between
NOT_FILLED = (0.0, 0.0, 0.0, 1.0)  # what a message has that nobody gave an orientation


class ImuColumns:
    """The columns that are computed from IMU readings."""

    COLUMNS = (
        Column(
            name="Roughness RMS",
            unit="m/s^2",
            meaning="How strongly the rover is shaken; 0 at rest, on a slope too.",
            formula="sqrt(mean(|a - g|^2)) over the samples since the row before. g: the orientation's "
            "vertical in the IMU frame times the parameter gravity; where the orientation is not filled "
            f"in, the first-order low-pass of a with a time constant of {SETTLING:g} s.",
            source="/imu/data linear_acceleration, orientation",
            rate_invariant="yes, within the sensor's bandwidth",
        ),
        Column(
            name="Peak Jerk",
            unit="m/s^3",
            meaning="The hardest jerk.",
            formula="max |a2 - a1| / (t2 - t1) since the row before, a the specific force vector, t "
            f"the header stamps, steps of up to {LONGEST_STEP:g} s.",
            source="/imu/data linear_acceleration",
            rate_invariant="no: a faster IMU resolves shorter, harder jerks; compare equal rates",
        ),
    )

    def __init__(self, gravity: float) -> None:
        self.gravity = gravity  # m/s^2
        self._last: tuple[int, Vector3] | None = None
        self._lasting: Vector3 = (0.0, 0.0, 0.0)  # what lasts of the acceleration, m/s^2
        self._begin()

    def _begin(self) -> None:
        self._squares, self._count = 0.0, 0
        self._jerk: float | None = None

    def add(self, stamp_ns: int, acceleration: Vector3, orientation: Quaternion | None) -> None:
        """Takes a sample that the metrics have used; arguments as of `MetricsSession.take_imu`."""
        step = self._step(stamp_ns)
        if step and self._last is not None:
            self._jerk = max(self._jerk or 0.0, math.dist(acceleration, self._last[1]) / step)
        self._settle(step, acceleration)
        vertical = up(orientation)
        gravity = self._lasting if vertical is None else [self.gravity * each for each in vertical]
        if stamp_ns or vertical is not None:  # without a stamp nothing tells what lasts
            self._squares += math.dist(acceleration, gravity) ** 2
            self._count += 1
        self._last = (stamp_ns, acceleration)

    def cells(self) -> tuple[Cell, ...]:
        """Returns the cells of a row; both begin anew."""
        rms = math.sqrt(self._squares / self._count) if self._count else None
        jerk = self._jerk
        self._begin()
        return rms, jerk

    def _step(self, stamp_ns: int) -> float | None:
        if self._last is None:
            return None
        step = (stamp_ns - self._last[0]) / 1e9
        return step if 0.0 <= step <= LONGEST_STEP else None

    def _settle(self, step: float | None, acceleration: Vector3) -> None:
        """Lets the estimate of gravity follow; after a gap it starts from the sample."""
        share = 1.0 if step is None else -math.expm1(-step / SETTLING)
        x, y, z = (g + share * (a - g) for g, a in zip(self._lasting, acceleration, strict=True))
        self._lasting = (x, y, z)


def up(orientation: Quaternion | None) -> Vector3 | None:
    """Returns the world's vertical in the sensor's frame; None if no orientation was filled in."""
    if orientation is None or orientation == NOT_FILLED or not 0.99 < math.hypot(*orientation) < 1.01:
        return None
    return matrix(orientation)[2]
