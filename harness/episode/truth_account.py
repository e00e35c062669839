"""The truth along a run, for its manifest: fed batch by batch, in memory that does not grow with it."""

import math
from dataclasses import dataclass

import numpy as np

from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.episode.mission import MissionAccount, MissionOutcome
from harness.samples import ContactEvent, TruthState, Vector3

MOST_EVENTS = 1000
MOST_POINTS = 1000  # of the path
ROUGHNESS_STEP = 1e-4  # [m]: resolution of its percentiles
ROUGHNESS_LIMIT = 1.0  # [m]: what is rougher counts as that


@dataclass(frozen=True, slots=True)
class TruthAlong:
    """What a run met on its way.

    Attributes:
        events: Its first MOST_EVENTS contact events in the order of their ends.
        event_count: How many there were.
        path: Position of the model frame [m] every `path_period_s` seconds, from that on.
        path_period_s: 1 s, twice as long whenever there are MOST_POINTS.
        roughness_p50: Median over time of the terrain's roughness under the wheels [m], to a tenth of
            a millimetre; `roughness_p95` is the 95th percentile; NaN where none was measured.
        mission: What became of way points and targets; None of a run without either.
        tipped_over_s: When the rover first lay on its side or roof, to 50 ms [s]; NaN if never.
    """

    events: tuple[ContactEvent, ...] = ()
    event_count: int = 0
    path: tuple[Vector3, ...] = ()
    path_period_s: float = 1.0
    roughness_p50: float = math.nan
    roughness_p95: float = math.nan
    tipped_over_s: float = math.nan
    mission: MissionOutcome | None = None


class TruthAccount:
    """Sums up one run, and its mission if it has one; `along` may be asked at any time."""

    def __init__(self, mission: MissionAccount | None = None) -> None:
        self._mission = mission
        self._events: list[ContactEvent] = []
        self._event_count = 0
        self._open: tuple[ContactEvent, ...] = ()
        self._path: list[Vector3] = []
        self._period_ns = NANOSECONDS
        self._tipped_over_s = math.nan
        self._roughness = np.zeros(round(ROUGHNESS_LIMIT / ROUGHNESS_STEP) + 1, dtype=np.int64)

    def take(self, batch: Batch) -> None:
        """Takes the next batch of the run."""
        self._open = batch.open_events
        if batch.truth.tipped_over and math.isnan(self._tipped_over_s):
            self._tipped_over_s = batch.truth.time_ns / NANOSECONDS
        if self._mission is not None:
            truth = batch.truth
            self._mission.take(truth.time_ns / NANOSECONDS, truth.position[:2], truth.resets)
        if batch.events:
            self._event_count += len(batch.events)
            self._events += batch.events[: MOST_EVENTS - len(self._events)]
        if batch.truth.time_ns % self._period_ns == 0:
            self._path.append(batch.truth.position)
            if len(self._path) == MOST_POINTS:
                self._path, self._period_ns = self._path[1::2], 2 * self._period_ns
        for tick in batch.ticks:
            if (state := tick.of(TruthState)) is not None:
                step = round(min(state.roughness, ROUGHNESS_LIMIT) / ROUGHNESS_STEP)
                self._roughness[step] += 1

    def along(self) -> TruthAlong:
        """Returns the account up to now; events that last are in it as they stand."""
        room = MOST_EVENTS - len(self._events)
        return TruthAlong(
            events=(*self._events, *self._open[:room]),
            event_count=self._event_count + len(self._open),
            path=tuple(self._path),
            path_period_s=self._period_ns / NANOSECONDS,
            roughness_p50=self._roughness_percentile(0.50),
            roughness_p95=self._roughness_percentile(0.95),
            tipped_over_s=self._tipped_over_s,
            mission=None if self._mission is None else self._mission.outcome(),
        )

    def _roughness_percentile(self, share: float) -> float:
        counted = np.cumsum(self._roughness)
        if not counted[-1]:
            return math.nan
        return float(np.searchsorted(counted, share * counted[-1])) * ROUGHNESS_STEP
