"""Choosing a threshold on one half of the episodes and scoring it, beside the default, on both."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring.estimate import Counts, Measure, estimate
from harness.tune.scoring.result import Candidate, Scores, Verdict
from rover_metrics.extended.settings import PARAMETERS

Records = Mapping[Part, Sequence[EpisodeRecord]]
# Of episodes for thresholds, shape (thresholds, episodes, kinds).
Count = Callable[[Sequence[EpisodeRecord], NDArray[np.float64]], Counts]


@dataclass(frozen=True)
class Scoring:
    """How a threshold is judged.

    Attributes:
        count: What is counted of episodes.
        measures: What is reported of a value, by name.
        objective: Name of the measure that is maximised.
        grid: The values to choose from.
        stratum: By what episodes are of a kind, for the intervals.
    """

    count: Count
    measures: Mapping[str, Measure]
    objective: str
    grid: NDArray[np.float64]
    stratum: Literal["driver", "terrain"] = "driver"

    def best(self, records: Sequence[EpisodeRecord]) -> float:
        """Returns the value with the highest objective; the middle one where several have it."""
        scores = self.measures[self.objective](self.count(records, self.grid).sum(axis=1))
        best = np.flatnonzero(scores == np.nanmax(scores))
        return float(self.grid[best[len(best) // 2]])

    def candidate(self, records: Records, value: float) -> Candidate:
        """Returns a value with its scores on all parts."""
        scores = {part: self.scores(some, value) for part, some in records.items()}
        return Candidate(value=value, scores=scores)

    def scores(self, records: Sequence[EpisodeRecord], value: float) -> Scores:
        """Returns all measures of a value."""
        counts = self.count(records, np.array([value]))[0]
        return self._estimates(records, counts, self.measures)

    def gain(self, records: Sequence[EpisodeRecord], values: tuple[float, float]) -> Scores:
        """Returns the first value minus the second by measure, on the same resampled episodes."""
        both = self.count(records, np.array(values))
        gains = {name: _difference(measure) for name, measure in self.measures.items()}
        return self._estimates(records, np.concatenate(both, axis=-1), gains)

    def _estimates(
        self, records: Sequence[EpisodeRecord], counts: Counts, measures: Mapping[str, Measure]
    ) -> Scores:
        strata = [getattr(record, self.stratum) for record in records]
        return {name: estimate(counts, measure, strata) for name, measure in measures.items()}


def _difference(measure: Measure) -> Measure:
    """Of sums of one value and, behind them, of another."""
    return lambda sums: np.subtract(*map(measure, np.split(sums, 2, axis=-1)))


def judged(
    parameter: str,
    scoring: Scoring,
    records: Records,
    *,
    lack: str | None,
    value: float | None = None,
    note: str = "",
) -> Verdict:
    """Returns the verdict on a threshold.

    Args:
        parameter: The threshold's name.
        scoring: How it is judged.
        records: The episodes.
        lack: Why the data support no value, or None if they do.
        value: One that was chosen by other means; the best of the grid on the training half if None.
        note: What the value holds for, or is made of.
    """
    info = PARAMETERS[parameter]
    default = scoring.candidate(records, info.default)
    verdict = Verdict(
        name=parameter, unit=info.unit, measure=scoring.objective, default=default, lack=lack
    )
    if lack is not None:
        return verdict
    best = scoring.best(records[Part.TRAIN]) if value is None else value
    gain = scoring.gain(records[Part.TEST], (best, info.default))
    return replace(verdict, tuned=scoring.candidate(records, best), gain=gain, note=note)


def lack_of(
    records: Records, things: str, count: Callable[[EpisodeRecord], int], fewest: int
) -> str | None:
    """Returns in a clause why the data support no value, None if they do.

    Args:
        records: The episodes; every part has to have enough.
        things: Which are counted, in words.
        count: How many an episode has.
        fewest: How many a part needs.
    """
    for part, some in records.items():
        counted = sum(map(count, some))
        if counted < fewest:
            return f"{counted} {things} in the {part} episodes; {fewest} are needed"
    return None
