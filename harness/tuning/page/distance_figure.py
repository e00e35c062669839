"""Figure of distance_threshold: how long steps are, and how long the jumps of resets."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.page.figure import METRIC, MUTED, TRUTH, Plot, Trace
from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.page.episodes import Subject
from harness.tuning.page.traces import OTHER, SHARE, figure, level, levels, line, titled

SHORTEST, LONGEST = 1e-3, 30.0  # [m] of the axis
QUANTILES = np.linspace(0.0, 1.0, 201)
SERIES = (
    ("largest_step", "longest step of a second", METRIC, "solid"),
    ("largest_stride", "the same with four poses lost", OTHER, "dash"),
    ("from_start", "jump of a reset at its end", TRUTH, "dashdot"),
)


def steps_and_jumps(subject: Subject) -> Plot | str:
    """Cumulative distributions over the seconds of the checking episodes."""
    study = subject.study.distance
    if not any(len(record.windows) for record in subject.checking):
        return "No second of poses in the checking episodes, so there is no figure."
    data = [
        _cumulative(name, _column(subject.checking, column), color, dash)
        for column, name, color, dash in SERIES
    ]
    possible = level(
        f"{study.possible_step:.3f} m: four poses lost at top speed", study.possible_step, "solid", MUTED
    )
    x = titled("distance [m]", type="log", range=np.log10([SHORTEST, LONGEST]).tolist())
    drawn = figure(
        data, x, titled("share of seconds below", **SHARE), [possible, *levels(study.verdict)]
    )
    what = f"steps up to {study.largest_step:.3f} m, {study.largest_stride:.3f} m with four poses lost"
    return subject.plot("steps", what, drawn)


def _cumulative(name: str, values: NDArray[np.float64], color: str, dash: str) -> Trace:
    return line(name, np.quantile(values, QUANTILES).clip(SHORTEST), QUANTILES, color, dash=dash)


def _column(records: Sequence[EpisodeRecord], name: str) -> NDArray[np.float64]:
    return np.concatenate([record.windows[name] for record in records]).astype(np.float64)
