"""A recording as plain series: what was commanded, what the rover did and felt, where it was."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Series = NDArray[np.float64]
APART = 1.0  # [s] of wheels and IMU against each other: their clocks differ
ALIGNED_RATE = 20.0  # [Hz] at which they are compared
TURNING = 0.05  # [rad/s] sd, from which on series of turning can be compared


def empty(columns: int) -> Series:
    """Returns a series of nothing, with a column of times and the others."""
    return np.empty((0, columns))


@dataclass(frozen=True, eq=False)
class Recording:
    """Series by rows, each with its time [s] first, in order; those that are not there are empty.

    Attributes:
        name: Of the file or the run.
        ground: What it drove on, as its file says; "" if that is not known.
        commands: v [m/s], yaw rate [rad/s].
        wheels: Speeds of the rims of the left and the right side, by the believed radius [m/s].
        currents: Of the left and the right side's motors [A].
        imu: Angular velocity [rad/s], acceleration with gravity [m/s^2]; NaN of axes without a record.
        poses: x, y [m], yaw that goes on past pi [rad].
        torques: What the motors of the left and the right side give, 0 of one that is dragged [N m].
        power: What the battery gives [W].
        steps: Begin and end of each commanded step [s].
    """

    name: str
    ground: str = ""
    commands: Series = field(default_factory=lambda: empty(3))
    wheels: Series = field(default_factory=lambda: empty(3))
    currents: Series = field(default_factory=lambda: empty(3))
    imu: Series = field(default_factory=lambda: empty(7))
    poses: Series = field(default_factory=lambda: empty(4))
    torques: Series = field(default_factory=lambda: empty(3))
    power: Series = field(default_factory=lambda: empty(2))
    steps: Series = field(default_factory=lambda: empty(2))

    @property
    def series(self) -> dict[str, Series]:
        """The series that are there, by name."""
        named = {
            "commands": self.commands, "wheels": self.wheels, "currents": self.currents,
            "imu": self.imu, "poses": self.poses, "torques": self.torques, "power": self.power,
        }  # fmt: skip
        return {name: values for name, values in named.items() if len(values) > 1}

    def within(self, begin: float, end: float) -> "Recording":
        """Returns the part from a time to another [s]; steps count that lie in it."""
        cut = {n: v[(v[:, 0] >= begin) & (v[:, 0] < end)] for n, v in self.series.items()}
        inside = (self.steps[:, 0] >= begin) & (self.steps[:, 1] <= end)
        cut["steps"] = self.steps[inside]
        return replace(self, **cut)  # type: ignore[arg-type]  # names of series alone


def at(series: Series, times: Series) -> Series:
    """Returns a series' values at times [s], held since the last sample, without the column of times."""
    index = np.clip(np.searchsorted(series[:, 0], times, side="right") - 1, 0, len(series) - 1)
    values: Series = series[index, 1:]
    return values


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
    times = np.arange(begin, end, 1 / ALIGNED_RATE)
    sides, felt = at(wheels, times), at(imu, times)[:, 2]
    told = (sides[:, 1] - sides[:, 0]) / track
    if not min(told.std(), felt.std()) >= TURNING or np.isnan(felt).any():
        return None
    likeness = np.correlate(felt - felt.mean(), told - told.mean(), "full")
    return float((int(np.argmax(likeness)) - len(times) + 1) / ALIGNED_RATE)
