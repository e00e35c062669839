"""What the IMU lets a metric feel of the ground, second by second, beside how rough it truly is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.tune.episodes.record import EpisodeRecord, Table

ROUGH = 0.003  # [m] RMS over 0.3 m: half of what the ERC Marsyard DEM has (5.5-6.2 mm)
STANDING = 0.05  # [m/s]: slower, no IMU can feel the ground
COLUMN_WINDOWS = 5  # seconds that Current Smoothness covers: 100 IMU samples at 20 Hz


class ImuEvents(NamedTuple):
    """What a metric says of stretches of an episode, and whether they are rough; each of shape (n,).

    Attributes:
        signal: What is compared with the threshold.
        rough: The truth.
        speed: Mean true speed [m/s].
    """

    signal: NDArray[np.float64]
    rough: NDArray[np.bool_]
    speed: NDArray[np.float64]

    @classmethod
    def joined(cls, each: Sequence["ImuEvents"]) -> "ImuEvents":
        """Returns those of several episodes, in their order."""
        none = cls(np.empty(0), np.empty(0, dtype=bool), np.empty(0))
        return cls(*map(np.concatenate, zip(*each, strict=True))) if each else none

    def within(self, low: float, high: float) -> "ImuEvents":
        """Returns those at a speed of at least `low` and less than `high` [m/s]."""
        inside = (self.speed >= low) & (self.speed < high)
        return ImuEvents(self.signal[inside], self.rough[inside], self.speed[inside])


@dataclass(frozen=True)
class Signal:
    """What one of the two thresholds is compared with, by its name on the page, from an episode."""

    parameter: str
    name: str
    imu_events: Callable[[EpisodeRecord], ImuEvents]


def _usable(windows: Table) -> NDArray[np.bool_]:
    # Rocks and hazards move the IMU but are not in the height map, whose roughness is the truth here.
    touching = windows["contact"] | (windows["rocks"] > 0.0)
    return np.asarray(~touching & (windows["speed"] >= STANDING))


def peak_acceleration(record: EpisodeRecord) -> ImuEvents:
    """Returns seconds with the largest acceleration in each."""
    windows = record.windows[_usable(record.windows)]
    return ImuEvents(windows["peak_acceleration"], windows["roughness"] > ROUGH, windows["speed"])


def current_smoothness(record: EpisodeRecord) -> ImuEvents:
    """Returns seconds, with the value that the column Current Smoothness has at their end."""
    windows, kernel = record.windows, np.full(COLUMN_WINDOWS, 1.0 / COLUMN_WINDOWS)
    if len(windows) < COLUMN_WINDOWS:
        return ImuEvents.joined([])
    means = {
        name: np.convolve(windows[name].astype(np.float64), kernel, mode="valid")
        for name in ("mean_smoothness", "roughness", "speed")
    }
    usable = np.convolve(_usable(windows), np.ones(COLUMN_WINDOWS), mode="valid") == COLUMN_WINDOWS
    return ImuEvents(
        means["mean_smoothness"][usable], means["roughness"][usable] > ROUGH, means["speed"][usable]
    )


SIGNALS = (
    Signal("rough_terrain_threshold", "largest |a| of a second", peak_acceleration),
    Signal("smoothness_threshold", "Current Smoothness, |a| + |w| over 5 s", current_smoothness),
)
