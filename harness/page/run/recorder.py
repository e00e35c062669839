"""What the report of a run is made from, watched batch by batch.

The run is cut into stretches of equal length, each with its extremes, so that no peak and no contact
is lost however long it takes: when there are too many stretches, every two become one, so that memory
does not grow with the run.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness import samples
from harness.base.sim_time import CONTROL_PERIOD_NS, NANOSECONDS
from harness.episode.batch import Batch
from harness.samples import PlacedScan, SoilState, Vector3

BATCHES_PER_STRETCH = 2  # at first: 0.1 s
FEWEST_STRETCHES = 1500  # of a long run, and twice as many at most


@dataclass(frozen=True, slots=True)
class Approach:
    """How near somebody was: from the model frame to the person's axis, from above."""

    distance: float  # between the two [m]
    time_s: float  # when [s]
    rover: tuple[float, float]  # where the rover was, x and y [m]
    person: tuple[float, float]  # where the person was, x and y [m]


@dataclass(frozen=True, slots=True)
class Stretch:
    """A short piece of a run, up to and including its last tick."""

    time_s: float  # its end [s]; `position` [m] and `path_length` since the start [m] are those then
    position: Vector3
    path_length: float
    # smallest |a| of its IMU samples, gravity included [m/s^2], or inf
    lowest_acceleration: float = math.inf
    highest_acceleration: float = -math.inf  # largest of them, or -inf
    nearest_range: float = math.inf  # nearest finite range of its scans [m], or inf
    contact_s: float = 0.0  # time in contact with a hazard [s]
    people: tuple[Vector3, ...] = ()  # where people are at its end [m]
    approaches: tuple[Approach, ...] = ()  # when each of them was nearest
    soil: SoilState | None = None  # what soil did to the wheels at its end

    @property
    def nearest_person(self) -> float:
        """Distance from the model frame to the nearest person's axis, from above [m], or inf."""
        return min((approach.distance for approach in self.approaches), default=math.inf)

    def followed_by(self, later: "Stretch") -> "Stretch":
        """Returns the stretch that both are together."""
        return replace(
            later,
            lowest_acceleration=min(self.lowest_acceleration, later.lowest_acceleration),
            highest_acceleration=max(self.highest_acceleration, later.highest_acceleration),
            nearest_range=min(self.nearest_range, later.nearest_range),
            contact_s=self.contact_s + later.contact_s,
            approaches=_nearest(self.approaches, later.approaches),
        )


class RunRecorder:
    """Watches the batches of one run.

    The last stretch of `track`, the run so far, may be shorter than the others; `last_scan` is the
    latest scan that fell on the tick of a pose, every 0.1 s.
    """

    def __init__(self, fewest_stretches: int = FEWEST_STRETCHES) -> None:
        self.track: list[Stretch] = []
        self.last_scan: PlacedScan | None = None
        self._fewest = fewest_stretches
        self._batches_per_stretch = BATCHES_PER_STRETCH
        self._batches = 0
        self._contact_s = 0.0
        self._place: Vector3 | None = None
        self._people: tuple[Vector3, ...] = ()

    @property
    def stretch_s(self) -> float:
        """How long a stretch is [s]."""
        return self._batches_per_stretch * CONTROL_PERIOD_NS / NANOSECONDS

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        stretch = self._stretch(batch)
        if self._batches % self._batches_per_stretch:
            self.track[-1] = self.track[-1].followed_by(stretch)
        else:
            self.track.append(stretch)
        self._batches += 1
        if self._batches == 2 * self._fewest * self._batches_per_stretch:
            pairs = zip(self.track[::2], self.track[1::2], strict=True)
            self.track = [first.followed_by(second) for first, second in pairs]
            self._batches_per_stretch *= 2

    def _stretch(self, batch: Batch) -> Stretch:
        accelerations: list[float] = []
        nearest = math.inf
        approaches: tuple[Approach, ...] = ()
        soil: SoilState | None = None
        for tick in batch.ticks:
            for sample in tick.samples:
                match sample:
                    case samples.Pose():
                        self._place = sample.position
                    case samples.ActorPoses():
                        self._people = sample.position
                        approaches = _nearest(approaches, self._approaches(sample.stamp_ns))
                    case samples.TruthState():
                        soil = sample.soil
                    case samples.Imu():
                        accelerations.append(math.hypot(*sample.linear_acceleration))
                    case samples.LaserScan():
                        nearest = min(nearest, _nearest_finite(sample.ranges))
                        if pose := tick.of(samples.Pose):
                            self.last_scan = PlacedScan(sample, pose)
        truth, touched_s = batch.truth, self._contact_s
        self._contact_s = truth.hazard_contact_s
        return Stretch(
            time_s=truth.time_ns / NANOSECONDS,
            position=truth.position,
            path_length=truth.path_length,
            lowest_acceleration=min(accelerations, default=math.inf),
            highest_acceleration=max(accelerations, default=-math.inf),
            nearest_range=nearest,
            contact_s=truth.hazard_contact_s - touched_s,
            people=self._people,
            approaches=approaches,
            soil=soil,
        )

    def _approaches(self, stamp_ns: int) -> tuple[Approach, ...]:
        if self._place is None:
            return ()
        rover, time_s = self._place[:2], stamp_ns / NANOSECONDS
        places = (person[:2] for person in self._people)
        return tuple(Approach(math.dist(rover, place), time_s, rover, place) for place in places)


def _nearest_finite(ranges: NDArray[np.floating]) -> float:
    """The nearest finite range [m], or inf; mostly it is simply the nearest."""
    nearest = float(np.minimum.reduce(ranges, initial=np.inf))
    return nearest if math.isfinite(nearest) else float(ranges[np.isfinite(ranges)].min(initial=np.inf))


def _nearest(one: tuple[Approach, ...], other: tuple[Approach, ...]) -> tuple[Approach, ...]:
    """The nearer of two moments of each person, the earlier one if they are alike."""
    if not (one and other):
        return one or other
    pairs = zip(one, other, strict=True)
    return tuple(min(pair, key=lambda approach: approach.distance) for pair in pairs)
