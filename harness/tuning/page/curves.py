"""Curves over thresholds: scores per event, and what scikit-learn makes of single scans and seconds."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.metrics import average_precision_score, precision_recall_curve, roc_auc_score, roc_curve

from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.scoring.alarms import EVENT_MEASURES, Detector, event_counts
from harness.tuning.scoring.choose import by_driver
from harness.tuning.scoring.estimate import Estimate, estimate

MOST_POINTS = 150  # of a curve on the page
FAR = 1e3  # [m]: stands for a scan without any return; nearer than everything is its negative

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """A curve with the area under it."""

    x: Values
    y: Values
    area: float


@dataclass(frozen=True)
class Labelled:
    """A score that rises with how sure a detector is, and the truth, both of shape (n,)."""

    score: Values
    truth: NDArray[np.bool_]

    @property
    def has_both_classes(self) -> bool:
        """Without them there is no curve."""
        return bool(self.truth.any() and not self.truth.all())


def event_scores(
    detector: Detector, records: Sequence[EpisodeRecord], thresholds: Values
) -> dict[str, Values]:
    """Every measure of alarms at every threshold."""
    sums = event_counts(detector, records, thresholds).sum(axis=1)
    return {name: np.asarray(measure(sums)) for name, measure in EVENT_MEASURES.items()}


def event_intervals(
    detector: Detector, records: Sequence[EpisodeRecord], thresholds: Values, measure: str
) -> list[Estimate]:
    """One measure of alarms at every threshold, with its interval."""
    strata = [by_driver(record) for record in records]
    counts = event_counts(detector, records, thresholds)
    return [estimate(row, EVENT_MEASURES[measure], strata) for row in counts]


def scans(detector: Detector, records: Sequence[EpisodeRecord]) -> Labelled:
    """Every scan: how near its detector sees something, and whether there is contact."""
    if not records:
        return Labelled(np.empty(0), np.empty(0, dtype=bool))
    distance = np.concatenate([detector(record) for record in records]).astype(np.float64)
    contact = np.concatenate([record.scans["contact"] for record in records])
    return Labelled(-np.clip(distance, -FAR, FAR), contact)


def roc(labelled: Labelled) -> Curve:
    """False positive rate, true positive rate."""
    false, true, _ = roc_curve(labelled.truth, labelled.score)
    return _thinned(false, true, float(roc_auc_score(labelled.truth, labelled.score)))


def precision_recall(labelled: Labelled) -> Curve:
    """Recall, precision; the area is the average precision."""
    precision, recall, _ = precision_recall_curve(labelled.truth, labelled.score)
    area = float(average_precision_score(labelled.truth, labelled.score))
    # The last point, no recall at full precision, is of no threshold.
    return _thinned(recall[-2::-1], precision[-2::-1], area)


def _thinned(x: Values, y: Values, area: float) -> Curve:
    """Points at even distances along the curve, its ends among them."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
    kept = np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], MOST_POINTS)))
    kept = np.unique(np.concatenate((kept.clip(max=len(x) - 1), [len(x) - 1])))
    return Curve(x[kept], y[kept], area)
