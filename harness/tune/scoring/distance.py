"""distance_threshold: longer than every step that a rover can make, shorter than the jump of a reset."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.tune.episodes.recompute import STRIDE
from harness.tune.episodes.record import WINDOW, EpisodeRecord
from harness.tune.scoring.choose import Records, Scoring, Verdict, judged, lack_of
from harness.tune.scoring.estimate import Counts, Measure, share

PARAMETER = "distance_threshold"
POSE_PERIOD = 0.02  # [s]
COARSEST, STEP = 1.0, 0.01  # [m]
FEWEST_SECONDS = 100  # of each part
NOTE = "for poses at 50 Hz, four in a row of which may be lost"
SECONDS, REFUSED, TAKEN = range(3)


@dataclass(frozen=True, kw_only=True)
class DistanceStudy:
    """Steps and jumps of one robot."""

    verdict: Verdict
    possible_step: float  # what it covers at top speed while four poses are lost [m]
    largest_step: float  # that was seen between two poses that follow each other [m]
    largest_stride: float  # that was seen with four poses lost [m]


def study_distance(records: Records, rover: RoverSpec) -> DistanceStudy:
    """Returns the verdict on the default and on a value above every plausible step."""
    everything = (record.windows for some in records.values() for record in some)
    windows = np.concatenate([np.empty(0, WINDOW), *everything])
    possible = rover.top_speed * STRIDE * POSE_PERIOD
    grid = np.round(np.arange(math.ceil(possible / STEP) * STEP, COARSEST, STEP), 2)
    scoring = Scoring(_counts, MEASURES, "balanced accuracy", grid)
    lack = lack_of(records, ("second", " of poses"), lambda record: len(record.windows), FEWEST_SECONDS)
    return DistanceStudy(
        verdict=judged(PARAMETER, scoring, records, lack=lack, note=NOTE),
        possible_step=possible,
        largest_step=float(windows["largest_step"].max(initial=0.0)),
        largest_stride=float(windows["largest_stride"].max(initial=0.0)),
    )


def _counts(records: Sequence[EpisodeRecord], thresholds: NDArray[np.float64]) -> Counts:
    """Seconds, each with a reset at its end; those with a step refused; resets taken for driving."""
    counts = np.zeros((len(thresholds), len(records), 3))
    for place, record in enumerate(records):
        refused = record.windows["largest_stride"] >= thresholds[:, None]
        taken = record.windows["from_start"] < thresholds[:, None]
        counts[:, place, SECONDS] = len(record.windows)
        counts[:, place, REFUSED], counts[:, place, TAKEN] = refused.sum(axis=1), taken.sum(axis=1)
    return counts


# Of resets, one each second, whose jump would count as travel; of seconds with a step that is refused.
_false_accept_rate, _false_reject_rate = share(TAKEN, SECONDS), share(REFUSED, SECONDS)
MEASURES: dict[str, Measure] = {
    "balanced accuracy": lambda sums: 1 - (_false_accept_rate(sums) + _false_reject_rate(sums)) / 2,
    "false accept rate": _false_accept_rate,
    "false reject rate": _false_reject_rate,
}
