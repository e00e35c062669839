"""Quantities over time: those of the truth are watched as the run goes on."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.episode.mission import MissionAccount, MissionState
from harness.samples import ActorPoses, Pose, Sample, TruthState, Vector3
from harness.scenario.quantities import NO_VALUE, Snapshot, quantity_of
from rover_metrics.core import rotation

SAMPLES: set[type[Sample]] = {Pose, TruthState, ActorPoses}  # that quantities of the truth are made of
STILL = TruthState(0, False, False, False, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0, 0.0), 0.0)


@dataclass(frozen=True)
class Series:
    """A quantity over time.

    Attributes:
        times: Seconds from the start, ascending.
        values: As many; NaN where there was none.
        nothing: What is said where there is no value at all.
        is_tally: Whether it is the number of values that is judged, whatever they are.
    """

    times: NDArray[np.float64]
    values: NDArray[np.float64]
    unit: str = ""
    nothing: str = NO_VALUE
    is_tally: bool = False


class TruthSeries:
    """An observer of a run that keeps the quantities of the truth that are asked for.

    Args:
        names: Of quantities of the truth.
        goal: x and y of the goal [m] and how near is near enough [m]; None without one.
        mission: Follows the rover through targets and route; None without either.
    """

    def __init__(
        self,
        names: Iterable[str],
        goal: tuple[float, float, float] | None = None,
        mission: MissionAccount | None = None,
    ) -> None:
        known = {name: quantity_of(name) for name in names}
        self._quantities = {name: one for name, one in known.items() if one is not None}
        self._goal, self._mission = goal, mission
        self._times: list[float] = []
        self._values: list[tuple[float, ...]] = []
        self._state, self._goal_s, self._tilt = STILL, math.nan, 0.0

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        tilts, apart = [], []
        for tick in batch.ticks:
            self._state = tick.of(TruthState) or self._state
            if (pose := tick.of(Pose)) is not None:
                tilts.append(rotation.tilt(pose.orientation))
                if (people := tick.of(ActorPoses)) is not None:  # 30 Hz: once or twice a period
                    apart += [math.dist(pose.position[:2], place[:2]) for place in people.position]
        self._tilt = max(tilts, default=self._tilt)
        time_s = batch.truth.time_ns / NANOSECONDS
        distance = self._distance(batch.truth.position)
        if self._goal is not None and math.isnan(self._goal_s) and distance <= self._goal[2]:
            self._goal_s = time_s
        mission = MissionState()
        if self._mission is not None:
            mission = self._mission.take(time_s, batch.truth.position[:2], batch.truth.resets)
        snapshot = Snapshot(
            *(batch.truth, self._state, self._tilt, distance, self._goal_s),
            person_distance=min(apart, default=math.nan),
            mission=mission,
        )
        self._times.append(time_s)
        self._values.append(tuple(q.value(snapshot) for q in self._quantities.values()))

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
