"""What can be expected of a run: quantities by name, and what they were over time."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.episode.batch import Batch
from harness.errors import unknown
from harness.report.log import NOTES_COLUMN, TIME_COLUMN
from harness.samples import ContactKind, Pose, TruthState, Vector3
from harness.sim_time import NANOSECONDS
from harness.truth.traversal import Truth
from rover_metrics.extended.metrics import EXTENDED_HEADER

NO_VALUE = "there is no value"
SAMPLED = 0.05  # [s] between two values of the truth
STILL = TruthState(0, False, False, False, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0, 0.0), 0.0)


class Moment(NamedTuple):
    """What the simulator knows at the end of a control period of 50 ms.

    Attributes:
        truth: Totals since the start.
        state: The latest sample of the truth.
        tilt: Largest angle between the rover's and the world's vertical in this period [rad].
        goal_distance: From the model frame to the goal, in the plane [m]; NaN without a goal.
        goal_s: When the rover was first as near to its goal as it must be [s]; NaN before.
    """

    truth: Truth
    state: TruthState
    tilt: float
    goal_distance: float
    goal_s: float


@dataclass(frozen=True)
class Quantity:
    """A quantity of the truth.

    Attributes:
        unit: Of its values; empty for counts and flags.
        meaning: In a sentence.
        value: Takes it out of a moment.
        contact: The contacts that it counts.
        nothing: What is told where it never had a value.
    """

    unit: str
    meaning: str
    value: Callable[[Moment], float]
    contact: ContactKind | None = None
    nothing: str = NO_VALUE


_WHEELS = ("front_left", "rear_left", "front_right", "rear_right")

QUANTITIES: dict[str, Quantity] = {
    "truth.hazard_contacts": Quantity(
        "", "Contacts with hazards so far.", lambda m: m.truth.hazard_contacts, "hazard"
    ),
    "truth.hazard_contact_s": Quantity(
        "s", "Time in contact with a hazard so far.", lambda m: m.truth.hazard_contact_s, "hazard"
    ),
    "truth.rock_contacts": Quantity(
        "", "Contacts with rocks so far.", lambda m: m.truth.rock_contacts, "rock"
    ),
    "truth.rock_contact_s": Quantity(
        "s", "Time in contact with a rock so far.", lambda m: m.truth.rock_contact_s, "rock"
    ),
    "truth.scrapes": Quantity(
        "", "Times so far that the body touched the ground.", lambda m: m.truth.scrapes, "scrape"
    ),
    "truth.scrape_s": Quantity(
        "s", "Time so far in which the body touched the ground.", lambda m: m.truth.scrape_s, "scrape"
    ),
    "truth.contact_force": Quantity(
        "N", "Largest normal force of a hazard in 50 ms.", lambda m: m.state.contact_force, "hazard"
    ),
    "truth.tilt_deg": Quantity(
        "deg", "Angle between the rover's and the world's vertical.", lambda m: math.degrees(m.tilt)
    ),
    "truth.tipped_over": Quantity(
        "", "1 once the rover has lain on its side or roof.", lambda m: m.truth.tipped_over
    ),
    "truth.speed": Quantity("m/s", "Forward speed, negative backwards.", lambda m: m.state.speed),
    "truth.path_length": Quantity("m", "Path so far.", lambda m: m.truth.path_length),
    "truth.roughness": Quantity("m", "Of the terrain under the wheels.", lambda m: m.state.roughness),
    "truth.x": Quantity("m", "Position in the world.", lambda m: m.truth.position[0]),
    "truth.y": Quantity("m", "Position in the world.", lambda m: m.truth.position[1]),
    "truth.z": Quantity("m", "Position in the world.", lambda m: m.truth.position[2]),
    "truth.resets": Quantity("", "Times that it was put back so far.", lambda m: m.truth.resets),
    "truth.slip": Quantity(
        "", "Mean magnitude of the wheels' slip ratios.", lambda m: sum(map(abs, m.state.slip)) / 4
    ),
    **{
        f"truth.slip.{wheel}": Quantity("", "Slip ratio, -1 to 1.", lambda m, i=i: m.state.slip[i])  # type: ignore[misc]
        for i, wheel in enumerate(_WHEELS)
    },
    "truth.goal_distance": Quantity("m", "To the goal, in the plane.", lambda m: m.goal_distance),
    "truth.goal_s": Quantity(
        "s",
        "When the goal was reached; no value before.",
        lambda m: m.goal_s,
        nothing="the goal was not reached",
    ),
}


GOAL = "truth.goal"  # how the names of those begin that need a goal
LOG = "log."  # and the name of a column
RUN = {"run.lost_messages": "Messages given up.", "run.rows": "Rows of the log."}


def names() -> tuple[str, ...]:
    """Returns all quantities; those of the log are its columns with numbers, also the extended ones."""
    columns = [f"{LOG}{name}" for name in EXTENDED_HEADER if name not in (TIME_COLUMN, NOTES_COLUMN)]
    return (*QUANTITIES, *RUN, *columns)


def check_name(name: str) -> str | None:
    """Returns what to tell of a quantity that does not exist, None of one that does."""
    return None if name in names() else unknown("quantity", name, names())


@dataclass(frozen=True)
class Series:
    """A quantity over time.

    Attributes:
        times: Seconds from the start, ascending.
        values: As many; NaN where there was none.
        unit: Of the values.
        nothing: What is told where there is no value at all.
    """

    times: NDArray[np.float64]
    values: NDArray[np.float64]
    unit: str = ""
    nothing: str = NO_VALUE


class TruthSeries:
    """An observer of a run that keeps the quantities of the truth that are asked for.

    Args:
        names: Of QUANTITIES.
        goal: x and y of the goal [m] and how near is near enough [m]; None without one.
    """

    def __init__(self, names: Iterable[str], goal: tuple[float, float, float] | None = None) -> None:
        self._quantities = {name: QUANTITIES[name] for name in names}
        self._goal = goal
        self._times: list[float] = []
        self._values: list[tuple[float, ...]] = []
        self._state, self._goal_s, self._tilt = STILL, math.nan, 0.0

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        tilts = []
        for tick in batch.ticks:
            for sample in tick.samples:
                if isinstance(sample, TruthState):
                    self._state = sample
                elif isinstance(sample, Pose):
                    tilts.append(_tilt(sample))
        self._tilt = max(tilts, default=self._tilt)
        time_s = batch.truth.time_ns / NANOSECONDS
        distance = self._distance(batch.truth.position)
        if self._goal is not None and math.isnan(self._goal_s) and distance <= self._goal[2]:
            self._goal_s = time_s
        moment = Moment(batch.truth, self._state, self._tilt, distance, self._goal_s)
        self._times.append(time_s)
        self._values.append(tuple(q.value(moment) for q in self._quantities.values()))

    def _distance(self, position: Vector3) -> float:
        if self._goal is None:
            return math.nan
        return math.hypot(position[0] - self._goal[0], position[1] - self._goal[1])

    def series(self) -> dict[str, Series]:
        """Returns each quantity over time, every 50 ms."""
        times = np.array(self._times)
        values = np.array(self._values, dtype=float).reshape(len(times), len(self._quantities))
        pairs = zip(self._quantities.items(), values.T, strict=True)
        return {name: Series(times, column, q.unit, q.nothing) for (name, q), column in pairs}


def _tilt(pose: Pose) -> float:
    """Angle [rad] between the vertical axes of a pose and the world: R_zz is 1 - 2 (x^2 + y^2)."""
    x, y, _, _ = pose.orientation
    return math.acos(max(-1.0, min(1.0, 1.0 - 2.0 * (x * x + y * y))))
