"""Figures of single scans: ROC and precision over recall of every detector, as scikit-learn has them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.metrics import average_precision_score, precision_recall_curve, roc_auc_score, roc_curve

from harness.page.figure import Plot, Trace, titled
from harness.tuning.page.contact_figures import STYLES, Values, operating_points
from harness.tuning.page.subject import SHARE, Subject, chance, curve, figure
from harness.tuning.scoring.alarms import DETECTORS
from harness.tuning.scoring.collision import REFERENCE_DETECTOR

MOST_POINTS = 150  # of a curve on the page
FAR = 1e3  # [m]: stands for a scan without any return; nearer than everything is its negative
ONE_CLASS = "The scans of the test episodes are all of one class, so there is no curve."


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


def scan_roc(subject: Subject) -> Plot | str:
    """Returns true over false positive rate of every detector, or why there is none."""
    scans = _scans(subject)
    if not scans[REFERENCE_DETECTOR].has_both_classes:
        return ONE_CLASS
    curves = {name: roc(labelled) for name, labelled in scans.items()}
    axes = titled("false positive rate", **SHARE), titled("true positive rate", **SHARE)
    places = _places(subject, "false positive rate", "recall")
    drawn = figure([chance("chance"), *_lines(curves, "AUC"), *places], *axes)
    return subject.plot("roc", f"ROC of single scans; {_areas(curves)}", drawn)


def scan_precision_recall(subject: Subject) -> Plot | str:
    """Returns precision over recall of every detector, or why there is none."""
    scans = _scans(subject)
    if not scans[REFERENCE_DETECTOR].has_both_classes:
        return ONE_CLASS
    curves = {name: precision_recall(labelled) for name, labelled in scans.items()}
    share = float(scans[REFERENCE_DETECTOR].truth.mean())
    guess = chance(f"chance: {100 * share:.1f} % of all scans", (share, share))
    axes = titled("recall", **SHARE), titled("precision", **SHARE)
    drawn = figure([guess, *_lines(curves, "AP"), *_places(subject, "recall", "precision")], *axes)
    return subject.plot("pr", f"precision over recall; {_areas(curves)}", drawn)


def roc(labelled: Labelled) -> Curve:
    """Returns false and true positive rate."""
    false, true, _ = roc_curve(labelled.truth, labelled.score)
    return _thinned(false, true, float(roc_auc_score(labelled.truth, labelled.score)))


def precision_recall(labelled: Labelled) -> Curve:
    """Returns recall and precision; the area is the average precision."""
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


def _scans(subject: Subject) -> dict[str, Labelled]:
    """Every test scan by detector: how near that sees something, and whether there is contact."""
    if not subject.test:
        return dict.fromkeys(DETECTORS, Labelled(np.empty(0), np.empty(0, dtype=bool)))
    contact = np.concatenate([record.scans["contact"] for record in subject.test])
    return {
        name: Labelled(-np.clip(np.concatenate([*map(detector, subject.test)]), -FAR, FAR), contact)
        for name, detector in DETECTORS.items()
    }


def _lines(curves: dict[str, Curve], area: str) -> list[Trace]:
    return [
        curve(f"{name}: {area} {one.area:.3f}", one.x, one.y, STYLES[name][0], dash=STYLES[name][1])
        for name, one in curves.items()
    ]


def _places(subject: Subject, x: str, y: str) -> list[Trace]:
    """Every detector at its value, by its measures."""
    return operating_points(
        subject.study.collision, lambda told: (told.scans[x].value, told.scans[y].value)
    )


def _areas(curves: dict[str, Curve]) -> str:
    return ", ".join(f"{curve.area:.3f} by {name}" for name, curve in curves.items())
