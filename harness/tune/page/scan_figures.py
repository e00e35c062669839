"""Figures of single scans: ROC and precision over recall of every detector, as scikit-learn has them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.metrics import average_precision_score, precision_recall_curve, roc_auc_score, roc_curve

from harness.page.figure import Plot, Trace, titled
from harness.tune.page.contact_figures import STYLES, Values, operating_points
from harness.tune.page.subject import SHARE, Subject, chance, curve
from harness.tune.scoring.alarms import DETECTORS

MOST_POINTS = 150  # of a curve on the page
FAR = 1e3  # [m]: stands for a scan without any return; nearer than everything is its negative
ONE_CLASS = "The scans of the test episodes are all of one class, so there is no curve."
# What each shows, the area under a curve, the measures on its axes, and the title of the second axis.
FIGURES = {
    "roc": ("ROC of single scans", "AUC", "false positive rate", "recall", "true positive rate"),
    "pr": ("precision over recall", "AP", "recall", "precision", "precision"),
}

Truth = NDArray[np.bool_]


@dataclass(frozen=True)
class Curve:
    """A curve with the area under it."""

    x: Values
    y: Values
    area: float


def scan_figures(subject: Subject) -> dict[str, Plot | str]:
    """Returns figures of every detector on single scans by name, or why there are none."""
    contact = np.concatenate([np.empty(0, bool), *(record.scans["contact"] for record in subject.test)])
    if not has_both_classes(contact):
        return dict.fromkeys(("roc", "pr"), ONE_CLASS)
    near = {  # how near each detector sees something
        name: -np.clip(np.concatenate([*map(detector, subject.test)]), -FAR, FAR)
        for name, detector in DETECTORS.items()
    }
    share = float(contact.mean())
    guess = chance(f"chance: {100 * share:.1f} % of all scans", (share, share))
    rocs = {name: roc(score, contact) for name, score in near.items()}
    curves = {name: precision_recall(score, contact) for name, score in near.items()}
    return {
        "roc": _figure(subject, "roc", rocs, chance("chance")),
        "pr": _figure(subject, "pr", curves, guess),
    }


def _figure(subject: Subject, name: str, curves: Mapping[str, Curve], guess: Trace) -> Plot:
    """The curves of all detectors, beside what guessing gives and every detector at its value."""
    title, area, x, y, y_title = FIGURES[name]
    lines = [
        curve(f"{detector}: {area} {one.area:.3f}", one.x, one.y, color, dash=dash)
        for detector, one in curves.items()
        for color, dash in [STYLES[detector]]
    ]
    study = subject.study.collision
    places = operating_points(study, lambda one: (one.scans[x].value, one.scans[y].value))
    areas = ", ".join(f"{one.area:.3f} by {detector}" for detector, one in curves.items())
    axes = titled(x, **SHARE), titled(y_title, **SHARE)
    return subject.plot(name, f"{title}; {areas}", [guess, *lines, *places], *axes)


def has_both_classes(truth: Truth) -> bool:
    """Returns whether there is a curve."""
    return bool(truth.any() and not truth.all())


def roc(score: Values, truth: Truth) -> Curve:
    """Returns false and true positive rate of a score that rises with how sure a detector is."""
    false, true, _ = roc_curve(truth, score)
    return _thinned(false, true, float(roc_auc_score(truth, score)))


def precision_recall(score: Values, truth: Truth) -> Curve:
    """Returns recall and precision of such a score; the area is the average precision."""
    precision, recall, _ = precision_recall_curve(truth, score)
    # The last point, no recall at full precision, is of no threshold.
    return _thinned(recall[-2::-1], precision[-2::-1], float(average_precision_score(truth, score)))


def _thinned(x: Values, y: Values, area: float) -> Curve:
    """Points at even distances along the curve, its ends among them."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
    kept = np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], MOST_POINTS)))
    kept = np.unique(np.concatenate((kept.clip(max=len(x) - 1), [len(x) - 1])))
    return Curve(x[kept], y[kept], area)
