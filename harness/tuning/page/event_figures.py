"""Figures of alarms against contacts: scores over the threshold, and detectors against each other."""

from collections.abc import Mapping

import numpy as np

from harness.page.figure import INK, METRIC, Plot, Trace
from harness.tuning.episodes.plan import Part
from harness.tuning.page.curves import Values, event_intervals, event_scores
from harness.tuning.page.detectors import STYLES, operating_points
from harness.tuning.page.episodes import Subject
from harness.tuning.page.traces import OTHER, SHARE, band, figure, levels, line, titled
from harness.tuning.scoring.alarms import DETECTORS
from harness.tuning.scoring.collision import GRID, SEEDS_DETECTOR
from harness.tuning.scoring.result import Scores

COARSE = GRID[::2]  # where there are intervals
FALSE_ALARMS = "false alarms per km"
NO_CONTACTS = "No contact with a hazard in the checking episodes, so there is no curve."
PARTS = (
    ("recall", Part.CHECKING, METRIC, "solid", 2.0),
    ("precision", Part.CHECKING, OTHER, "dash", 2.0),
    ("recall", Part.CHOOSING, METRIC, "dot", 1.5),
    ("precision", Part.CHOOSING, OTHER, "dashdot", 1.5),
)
THRESHOLD = titled("threshold [m]", range=[0.0, float(GRID[-1])])


def f1_over_threshold(subject: Subject) -> Plot | str:
    """F1 of the seed's detector, on both parts."""
    study, detector = subject.study.collision, DETECTORS[SEEDS_DETECTOR]
    if not study.contacts:
        return NO_CONTACTS
    f1 = {part: event_scores(detector, subject.records[part], GRID)["F1"] for part in Part}
    data = [
        *_interval_band(subject),
        line("choosing episodes", GRID, f1[Part.CHOOSING], INK, dash="dashdot", width=1.0),
        line("checking episodes", GRID, f1[Part.CHECKING]),
    ]
    best = GRID[int(np.nanargmax(f1[Part.CHECKING]))]
    what = f"F1 over the threshold; {np.nanmax(f1[Part.CHECKING]):.2f} at most, at {best:g} m"
    drawn = figure(data, THRESHOLD, titled("F1", **SHARE), levels(study.verdict))
    return subject.plot("f1", what, drawn)


def _interval_band(subject: Subject) -> list[Trace]:
    intervals = event_intervals(DETECTORS[SEEDS_DETECTOR], subject.checking, COARSE, "F1")
    edges = [
        (threshold, found.low, found.high)
        for threshold, found in zip(COARSE.tolist(), intervals, strict=True)
        if found.low is not None and found.high is not None
    ]
    if not edges:
        return []
    x, low, high = zip(*edges, strict=True)
    return band("95 % interval, checking episodes", x, low, high)


def parts_over_threshold(subject: Subject) -> Plot | str:
    """Precision and recall of the seed's detector, on both parts."""
    study, detector = subject.study.collision, DETECTORS[SEEDS_DETECTOR]
    if not study.contacts:
        return NO_CONTACTS
    scores = {part: event_scores(detector, subject.records[part], GRID) for part in Part}
    data = [
        line(f"{measure}, {part} episodes", GRID, scores[part][measure], color, dash=dash, width=width)
        for measure, part, color, dash, width in PARTS
    ]
    drawn = figure(data, THRESHOLD, titled("share", **SHARE), levels(study.verdict))
    return subject.plot("parts", "precision and recall over the threshold", drawn)


def trade_off(subject: Subject) -> Plot | str:
    """Recall against false alarms per kilometre, a curve per detector."""
    study = subject.study.collision
    if not study.contacts:
        return NO_CONTACTS
    points = operating_points(study, lambda told: _place(told.events.scores[Part.CHECKING]))
    frontiers = {
        name: frontier(event_scores(told, subject.checking, GRID)) for name, told in DETECTORS.items()
    }
    ends = [*(at[0][-1] for at in frontiers.values()), *(point["x"][0] or 0.0 for point in points)]
    data = [_frontier_line(name, at, 1.1 * max(ends)) for name, at in frontiers.items()] + points
    x = titled(FALSE_ALARMS, rangemode="tozero")
    what = "recall against false alarms per kilometre of four detectors"
    return subject.plot("trade-off", what, figure(data, x, titled("recall", **SHARE)))


def frontier(scores: Mapping[str, Values]) -> tuple[Values, Values]:
    """False alarms per km and the highest recall that no more of them allow, both rising."""
    false, recall = scores[FALSE_ALARMS], scores["recall"]
    order = np.lexsort((-recall, false))
    false, recall = false[order], recall[order]
    better = np.diff(np.maximum.accumulate(recall), prepend=-1.0) > 0.0
    return false[better], recall[better]


def _frontier_line(name: str, at: tuple[Values, Values], end: float) -> Trace:
    color, dash = STYLES[name]
    drawn = line(name, [*at[0], end], [*at[1], at[1][-1]], color, dash=dash)
    return drawn | {"line": drawn["line"] | {"shape": "hv"}}


def _place(scores: Scores) -> tuple[float, float]:
    return scores[FALSE_ALARMS].value, scores["recall"].value
