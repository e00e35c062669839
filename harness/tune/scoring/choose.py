"""Choosing a threshold on one half of the episodes, and what both say of it beside the default."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring import estimate as est
from harness.tune.scoring.estimate import Counts, Estimate, Measure
from rover_metrics.errors import counted
from rover_metrics.extended.settings import PARAMETERS

Scores = Mapping[str, Estimate]  # by measure
Records = Mapping[Part, Sequence[EpisodeRecord]]
# Of episodes for thresholds, shape (thresholds, episodes, kinds).
Count = Callable[[Sequence[EpisodeRecord], NDArray[np.float64]], Counts]


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """One value of a threshold, a bool if it is a switch, with how it did by part of the plan.

    The part on which it was chosen flatters it.
    """

    value: float
    scores: Mapping[Part, Scores]


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What the data say of one threshold of one robot."""

    name: str  # of the ROS parameter
    unit: str
    measure: str  # by which a value is chosen
    default: Candidate  # RoboTerrain's value
    tuned: Candidate | None = None  # what was chosen; None where the data support no value
    gain: Scores = field(default_factory=dict)  # tuned minus default on the test episodes, by measure
    lack: str | None = None  # why the data support no value, in a clause; None if they do
    note: str = ""  # what the tuned value holds for, or is made of

    @property
    def value(self) -> float | None:
        """What a parameter file should say: None where the default stays.

        Only a value that beats the default on episodes on which it was not chosen is supported, by more
        than resampling both together explains, and by more than the digits that are shown hide.
        """
        if self.tuned is None:
            return None
        low = self.gain[self.measure].low
        return self.tuned.value if low is not None and round(low, est.MOST_DIGITS) > 0.0 else None

    @property
    def digits(self) -> int:
        """How many digits its scores need, so that tuned and default do not look the same."""
        return est.FEWEST_DIGITS if self.tuned is None else est.digits_for(self.gain[self.measure])

    def written(self, candidate: Candidate) -> str:
        """Returns a value with its unit."""
        value = candidate.value
        return str(value).lower() if isinstance(value, bool) else f"{value:g} {self.unit}"

    @property
    def is_proven(self) -> bool:
        """Whether the intervals of tuned and default on the test episodes do not overlap."""
        if self.tuned is None:
            return False
        tuned, default = (one.scores[Part.TEST][self.measure] for one in (self.tuned, self.default))
        return tuned.low is not None and default.high is not None and tuned.low > default.high


@dataclass(frozen=True)
class Scoring:
    """How a threshold is judged."""

    count: Count  # what is counted of episodes
    measures: Mapping[str, Measure]  # what is reported of a value, by name
    objective: str  # name of the measure that is maximised
    grid: NDArray[np.float64]  # the values to choose from
    stratum: Literal["driver", "terrain"] = "driver"  # by what episodes are of a kind, for intervals

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
        return {name: est.estimate(counts, measure, strata) for name, measure in measures.items()}


def _difference(measure: Measure) -> Measure:
    """The difference of a measure between two values, whose sums stand one behind the other."""
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
    records: Records, thing: tuple[str, str], count: Callable[[EpisodeRecord], int], fewest: int
) -> str | None:
    """Returns in a clause why the data support no value, None if they do.

    Args:
        records: The episodes; every part has to have enough.
        thing: What is counted, one of them, and what else is said of it.
        count: How many an episode has.
        fewest: How many a part needs.
    """
    for part, some in records.items():
        there = sum(map(count, some))
        if there < fewest:
            return f"{counted(there, *thing)} in the {part} episodes; {fewest} are needed"
    return None
