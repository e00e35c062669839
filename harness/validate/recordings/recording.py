"""A recording as plain series: what was commanded, what the rover did and felt, where it was."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Series = NDArray[np.float64]
APART = 1.0  # [s] of wheels and IMU against each other: their clocks differ
ALIGNED_RATE = 20.0  # [Hz] at which they are compared
ROUNDED = 1e-3  # [s], more than what times of day lose as floats
TURNING = 0.05  # [rad/s] sd, from which on series of turning can be compared


def empty(columns: int) -> Series:
    """Returns a series of nothing, with a column of times and the others."""
    return np.empty((0, columns))


@dataclass(frozen=True, eq=False)
class Recording:
    """Series by rows, each with its time [s] first, in order; those that are not there are empty.

    Where there are two columns, the left and the right side's, the left is first. Axes of the IMU
    without a record are NaN.
    """

    name: str  # of the file or the run
    ground: str = ""  # what it drove on, as its file says; "" if that is not known
    commands: Series = field(default_factory=lambda: empty(3))  # v [m/s], yaw rate [rad/s]
    wheels: Series = field(default_factory=lambda: empty(3))  # of rims, by the believed radius [m/s]
    currents: Series = field(default_factory=lambda: empty(3))  # of both sides' motors [A]
    imu: Series = field(default_factory=lambda: empty(7))  # w [rad/s], a with gravity [m/s^2]
    poses: Series = field(default_factory=lambda: empty(4))  # x, y [m], yaw that goes on past pi [rad]
    torques: Series = field(default_factory=lambda: empty(3))  # of motors, 0 of one dragged [N m]
    power: Series = field(default_factory=lambda: empty(2))  # what the battery gives [W]
    steps: Series = field(default_factory=lambda: empty(2))  # begin and end of each commanded one [s]

    sources: Mapping[str, str] = field(default_factory=dict)  # topics of a bag, by series
    problems: tuple[str, ...] = ()  # what could not be read or is odd, a line each

    @property
    def series(self) -> dict[str, Series]:
        """The series that are there, by name."""
        names = ("commands", "wheels", "currents", "imu", "poses", "torques", "power")
        named: dict[str, Series] = {name: getattr(self, name) for name in names}
        return {name: values for name, values in named.items() if len(values) > 1}

    def within(self, begin: float, end: float) -> "Recording":
        """Returns the part from a time to another [s]; steps count that lie in it."""
        cut = {n: v[(v[:, 0] >= begin) & (v[:, 0] < end)] for n, v in self.series.items()}
        inside = (self.steps[:, 0] >= begin) & (self.steps[:, 1] <= end)
        cut["steps"] = self.steps[inside]
        return replace(self, **cut)  # type: ignore[arg-type]  # names of series alone


def moved(series: Series, seconds: float) -> Series:
    """Returns a series whose times are that much later [s]."""
    later: Series = series + np.eye(1, series.shape[1])[0] * seconds
    return later


def in_order(rows: Series) -> Series:
    """Returns rows in the order of their times [s], of each time the first."""
    ordered: Series = rows[np.argsort(rows[:, 0], kind="stable")]
    return ordered[np.diff(ordered[:, 0], prepend=-np.inf) > 0.0]


def changes(values: Series) -> NDArray[np.bool_]:
    """Returns which rows have other values than the row before; the first one has."""
    return np.concatenate([[True], (np.diff(values, axis=0) != 0.0).any(axis=1)])


def at(series: Series, times: Series) -> Series:
    """Returns a series' values at times [s], held since the last sample, without the column of times."""
    index = np.clip(np.searchsorted(series[:, 0], times, side="right") - 1, 0, len(series) - 1)
    values: Series = series[index, 1:]
    return values


def between(series: Series, times: Series) -> Series:
    """Returns a series' values at times [s], linear between samples, without the column of times."""
    return np.column_stack([np.interp(times, series[:, 0], values) for values in series[:, 1:].T])


def lag(recording: Recording, track: float) -> float | None:
    """Returns how much later the IMU's clock shows what the wheels do [s]; None where nothing turns.

    Args:
        recording: Has wheels and IMU.
        track: By which the sides' difference turns the rover [m].
    """
    wheels, imu = recording.wheels, recording.imu
    begin, end = max(wheels[0, 0], imu[0, 0]), min(wheels[-1, 0], imu[-1, 0])
    if end - begin < 5 * APART:
        return None
    # Where samples are as far apart, times of day are too coarse to tell each from the one before.
    times = np.arange(begin + ROUNDED, end, 1 / ALIGNED_RATE)
    sides, felt = at(wheels, times), at(imu, times)[:, 2]
    rolled = (sides[:, 1] - sides[:, 0]) / track
    if not min(rolled.std(), felt.std()) >= TURNING or np.isnan(felt).any():
        return None
    likeness = np.correlate(felt - felt.mean(), rolled - rolled.mean(), "full")
    return float((int(np.argmax(likeness)) - len(times) + 1) / ALIGNED_RATE)
