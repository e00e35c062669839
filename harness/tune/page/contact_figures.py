"""Figures of alarms against contacts: scores over the threshold, and detectors against each other."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from harness.page.figure import INK, METRIC, SCAN, Plot, Trace, band, titled
from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.page.subject import SHARE, Subject, curve, levels, mark
from harness.tune.scoring.alarms import DETECTORS, EVENT_MEASURES, NEAREST_RANGE, event_counts
from harness.tune.scoring.collision import GRID, CollisionStudy, DetectorStudy
from harness.tune.scoring.estimate import estimate

COARSE = GRID[::2]  # where there are intervals
THRESHOLD = titled("threshold [m]", range=[0.0, float(GRID[-1])])
FALSE_ALARMS = "false alarms per km"
NO_CONTACTS = "No contact with a hazard in the test episodes, so there is no curve."
# Hue says what is measured, the dash whether near returns count.
LOOKS = ((METRIC, "solid"), (METRIC, "dash"), (SCAN, "solid"), (SCAN, "dash"))
STYLES = dict(zip(DETECTORS, LOOKS, strict=True))
PARTS = (
    ("recall", Part.TEST, METRIC, "solid", 2.0),
    ("precision", Part.TEST, SCAN, "dash", 2.0),
    ("recall", Part.TRAIN, METRIC, "dot", 1.5),
    ("precision", Part.TRAIN, SCAN, "dashdot", 1.5),
)
NAMES = {Part.TRAIN: "training episodes", Part.TEST: "test episodes"}

Values = NDArray[np.float64]


def contact_figures(subject: Subject) -> dict[str, Plot | str]:
    """Returns figures of alarms by name, or why there are none."""
    if not subject.study.collision.contacts:
        return dict.fromkeys(("f1", "parts", "trade-off"), NO_CONTACTS)
    scores = {part: _event_scores(NEAREST_RANGE, records) for part, records in subject.records.items()}
    return {
        "f1": _f1_over_threshold(subject, {part: scores[part]["F1"] for part in Part}),
        "parts": _parts_over_threshold(subject, scores),
        "trade-off": _trade_off(subject),
    }


def _f1_over_threshold(subject: Subject, f1: Mapping[Part, Values]) -> Plot:
    data = [
        *_interval_band(subject),
        curve(NAMES[Part.TRAIN], GRID, f1[Part.TRAIN], INK, dash="dashdot", width=1),
        curve(NAMES[Part.TEST], GRID, f1[Part.TEST]),
    ]
    best = GRID[int(np.nanargmax(f1[Part.TEST]))]
    summary = f"F1 over the threshold; {np.nanmax(f1[Part.TEST]):.2f} at most, at {best:g} m"
    lines = levels(subject.study.collision.verdict)
    return subject.plot("f1", summary, data, THRESHOLD, titled("F1", **SHARE), lines)


def _parts_over_threshold(subject: Subject, scores: Mapping[Part, Mapping[str, Values]]) -> Plot:
    data = [
        curve(f"{measure}, {NAMES[part]}", GRID, scores[part][measure], color, dash=dash, width=width)
        for measure, part, color, dash, width in PARTS
    ]
    summary, lines = "precision and recall over the threshold", levels(subject.study.collision.verdict)
    return subject.plot("parts", summary, data, THRESHOLD, titled("share", **SHARE), lines)


def _trade_off(subject: Subject) -> Plot:
    """Recall against false alarms per kilometre for each detector."""
    points = operating_points(subject.study.collision, _place)
    frontiers = {name: frontier(_event_scores(name, subject.test)) for name in DETECTORS}
    ends = [*(price[-1] for price, _ in frontiers.values()), *(point["x"][0] or 0.0 for point in points)]
    data = [
        curve(name, [*price, 1.1 * max(ends)], [*recall, recall[-1]], color, dash=dash, shape="hv")
        for name, (price, recall) in frontiers.items()
        for color, dash in [STYLES[name]]
    ]
    axes = titled(FALSE_ALARMS, rangemode="tozero"), titled("recall", **SHARE)
    summary = "recall against false alarms per kilometre of four detectors"
    return subject.plot("trade-off", summary, data + points, *axes)


def frontier(scores: Mapping[str, Values]) -> tuple[Values, Values]:
    """Returns false alarms per km and the highest recall that no more of them allow, both rising."""
    false, recall = scores[FALSE_ALARMS], scores["recall"]
    order = np.lexsort((-recall, false))
    false, recall = false[order], recall[order]
    better = np.diff(np.maximum.accumulate(recall), prepend=-1.0) > 0.0
    return false[better], recall[better]


def operating_points(
    study: CollisionStudy, place: Callable[[DetectorStudy], tuple[float, float]]
) -> list[Trace]:
    """Returns a mark for each detector at its tuned value, and for the default, each at its place."""
    points = []
    for one in study.detectors:
        hover, color = f"{one.name} below {one.events.value:g} m", STYLES[one.name][0]
        points.append(mark("at its best value", *place(one), tuned=color, hover=hover))
    default = f"default {study.default.events.value:g} m"
    return [*points, mark("the default", *place(study.default), hover=default)]


def _place(detector: DetectorStudy) -> tuple[float, float]:
    scores = detector.events.scores[Part.TEST]
    return scores[FALSE_ALARMS].value, scores["recall"].value


def _event_scores(detector: str, records: Sequence[EpisodeRecord]) -> dict[str, Values]:
    """Every measure of alarms at every threshold."""
    sums = event_counts(DETECTORS[detector])(records, GRID).sum(axis=1)
    return {name: measure(sums) for name, measure in EVENT_MEASURES.items()}


def _interval_band(subject: Subject) -> list[Trace]:
    """F1 on the test episodes with its interval, where there is one."""
    strata = [record.driver for record in subject.test]
    counts = event_counts(DETECTORS[NEAREST_RANGE])(subject.test, COARSE)
    f1 = [estimate(row, EVENT_MEASURES["F1"], strata) for row in counts]
    edges = [(at, one.low, one.high) for at, one in zip(COARSE, f1, strict=True) if one.low is not None]
    return band("95 % interval, test episodes", *zip(*edges, strict=True)) if edges else []
