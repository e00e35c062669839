"""What is kept of an episode: raw extrema, so that any threshold can be scored later without driving.

Three tables: one row per scan, per second of IMU and pose samples, per contact with a hazard.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

SCHEMA = 1  # goes up with every change of the tables

# Half floats: a quarter of a millimetre at 0.5 m, 4 mm at 5 m; a sweep stays small enough to keep.
SCAN = np.dtype(
    [
        ("stamp_ms", "i4"),
        ("nearest", "f2"),  # smallest finite range [m]; inf without one
        ("near_returns", "u2"),  # beams that met something nearer than range_min (REP-117: -inf)
        ("footprint", "f2"),  # smallest distance from a finite return to the footprint [m]
        ("contact", "?"),  # the rover touched a hazard since the last scan
        ("speed", "f2"),  # true forward speed [m/s]
    ]
)
WINDOW = np.dtype(
    [
        ("time_s", "f4"),  # its end
        ("peak_acceleration", "f4"),  # largest |a| of its IMU samples, gravity included [m/s^2]
        ("mean_smoothness", "f4"),  # mean |a| + |w| [m/s^2 + rad/s]
        ("peak_smoothness", "f4"),  # largest |a| + |w|
        ("speed", "f4"),  # mean true speed [m/s]
        ("roughness", "f4"),  # mean RMS residual of the ground under the wheels over 0.3 m [m]
        ("rocks", "f4"),  # share of the time in contact with rocks
        ("contact", "?"),  # with a hazard
        ("largest_step", "f4"),  # between two poses that follow each other [m]
        ("largest_stride", "f4"),  # between two poses with four lost between them [m]
        ("from_start", "f4"),  # from its last pose to the episode's first: the step of a reset [m]
    ]
)
EVENT = np.dtype(
    [
        ("start_s", "f8"),
        ("end_s", "f8"),
        ("zone", "U8"),  # where on the rover: see Zone
        ("sight", "U24"),  # what the lidar had of the hazard: see Sight
        ("part", "U24"),  # of the rover
        ("force", "f4"),  # largest normal force [N]
        ("speed", "f4"),  # true forward speed at its start [m/s]
    ]
)

Table = NDArray[np.void]


class Zone(StrEnum):
    """The side of the rover that is touched."""

    FRONT = "front"
    SIDE = "side"
    REAR = "rear"


class Sight(StrEnum):
    """Whether finite ranges showed the hazard around the start of a contact, and if not, why."""

    SEEN = "seen"
    TOO_LOW = "below the lidar"
    TOO_NEAR = "nearer than range_min"
    MISSED = "out of its plane"


class Ending(StrEnum):
    """How an episode ended."""

    COMPLETE = "complete"
    LEFT_THE_MAP = "left the map"
    TIPPED_OVER = "tipped over"
    DIVERGED = "diverged"


@dataclass(frozen=True, eq=False)
class EpisodeRecord:
    """An episode in tables."""

    scans: Table  # of dtype SCAN
    windows: Table  # of dtype WINDOW
    events: Table  # of dtype EVENT
    ending: Ending  # a diverged episode is not to be scored
    path_length: float  # true path [m]
    driver: str
    terrain: str

    @property
    def times(self) -> NDArray[np.float64]:
        """Stamps of the scans [s]."""
        return np.asarray(self.scans["stamp_ms"] / 1000.0)

    @property
    def duration(self) -> float:
        """Time that the scans cover [s]."""
        return float(self.times[-1]) if self.scans.size else 0.0
