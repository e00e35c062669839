"""Seconds of steady driving: what the sides did, and how the rover moved and what its motors gave."""

import math
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.validate.recordings.recording import Recording, Series, changes

Flags = NDArray[np.bool_]

SETTLED = 1.5  # [s] after a change of the command
LENGTH, HOP = 2.0, 0.5  # [s]
STEADY = 0.06, 0.15  # largest sd of a side [m/s], or share of the sides' speed
SLOWEST = 0.05  # [m/s] of the faster side
PAIRS = 21  # of poses
FEWEST = 5  # samples of the wheels
APART = 0.1  # [m/s] of sides whose windows are of one kind
TURNING = 2 * APART  # by which sides differ in a turn
SKEW = 0.1  # of the speed by which the sides may differ straight on
MOST = 8  # kinds


@dataclass(frozen=True, eq=False)
class Steady:
    """Windows of steady driving, shape (n,) each; what was not recorded is NaN.

    Attributes:
        begin: [s].
        left, right: Speeds of the rims, by the believed radius [m/s].
        yaw_rate: [rad/s].
        ahead: Speed of the poses' place in the direction of the rover [m/s].
        left_current, right_current: Of the motors [A].
        weight: How many windows each stands for.
    """

    begin: Series
    left: Series
    right: Series
    yaw_rate: Series
    ahead: Series
    left_current: Series
    right_current: Series
    weight: Series

    @property
    def table(self) -> Series:
        """All fields as columns, shape (n, 8)."""
        return np.column_stack([getattr(self, name) for name in self.__dataclass_fields__])

    @property
    def mean(self) -> Series:
        """Mean speed of the sides [m/s]."""
        return (self.left + self.right) / 2

    @property
    def difference(self) -> Series:
        """Difference of the sides' speeds, right less left [m/s]."""
        return self.right - self.left

    @property
    def turns(self) -> Flags:
        """Which windows turn."""
        return np.abs(self.difference) > TURNING

    @property
    def spots(self) -> Flags:
        """Which windows turn on the spot."""
        return self.turns & (np.abs(self.mean) < np.abs(self.difference) / 4)

    @property
    def is_straight(self) -> Flags:
        """Which windows go straight on."""
        return self.drives & (np.abs(self.difference) < SKEW * np.abs(self.mean))

    @property
    def drives(self) -> Flags:
        """Which windows get somewhere."""
        return np.abs(self.mean) > APART


def steady(recording: Recording) -> Steady:
    """Returns the windows of a recording, in the order of time; its currents may come from torques."""
    commands = recording.commands
    times = np.append(commands[changes(commands[:, 1:]), 0], recording.wheels[-1, 0])
    rows = []
    for first, last in zip(times[:-1] + SETTLED, times[1:], strict=True):
        begin = first
        while begin + LENGTH <= last:
            row = window(recording, begin, begin + LENGTH)
            rows += [row] if row is not None else []
            begin += LENGTH if row is not None else HOP
    return Steady(*np.array(rows).reshape(-1, 8).T)


def window(recording: Recording, begin: float, end: float) -> tuple[float, ...] | None:
    """Returns a window, by the fields of Steady; None where the driving was not steady.

    Args:
        recording: Of a real rover, or of ours.
        begin: Of it [s].
        end: Of it [s].
    """
    part = recording.within(begin, end)
    if len(part.wheels) < FEWEST:
        return None
    left, right = np.median(part.wheels[:, 1:], axis=0).tolist()
    spread = float(part.wheels[:, 1:].std(axis=0).max())
    fastest = max(abs(left), abs(right))
    if fastest < SLOWEST or spread > max(STEADY[0], STEADY[1] * fastest):
        return None
    currents = np.median(part.currents[:, 1:], axis=0) if len(part.currents) else [np.nan, np.nan]
    return begin, left, right, *_moved(part, begin, end), *map(float, currents), 1.0


def _moved(part: Recording, begin: float, end: float) -> tuple[float, float]:
    """Yaw rate and speed ahead, of an arc along it: medians over pairs of poses half a window apart."""
    poses, half = part.poses, (end - begin) / 2
    if len(poses) < FEWEST:
        return (float(np.median(part.imu[:, 3])) if len(part.imu) else np.nan), np.nan
    firsts = np.linspace(poses[0, 0], poses[-1, 0] - half, PAIRS)
    (x, y, yaw), (x_then, y_then, yaw_then) = (
        [np.interp(times, poses[:, 0], poses[:, column]) for column in (1, 2, 3)]
        for times in (firsts, firsts + half)
    )
    middle, turned = (yaw + yaw_then) / 2, yaw_then - yaw
    chord = (x_then - x) * np.cos(middle) + (y_then - y) * np.sin(middle)
    ahead = chord / np.sinc(turned / math.tau)
    return float(np.median(turned)) / half, float(np.median(ahead)) / half


def kinds(some: Steady) -> Steady:
    """Returns the medians of windows that are alike, the most frequent kinds first."""
    cells = np.round(np.column_stack([some.left, some.right]) / APART).astype(int)
    _, kind, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    chosen = np.argsort(-counts, kind="stable")[:MOST]
    with warnings.catch_warnings(action="ignore"):  # of what was not recorded
        table = np.array([np.nanmedian(some.table[kind == each], axis=0) for each in chosen])
    table = table.reshape(-1, 8)
    table[:, -1] = counts[chosen]
    return Steady(*table.T)
