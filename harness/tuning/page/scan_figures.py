"""Figures of single scans: ROC and precision over recall of every detector, as scikit-learn has them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.metrics import average_precision_score, precision_recall_curve, roc_auc_score, roc_curve

from harness.page.figure import Layout, Plot, Trace, titled
from harness.tuning.page.contact_figures import STYLES, Values, operating_points
from harness.tuning.page.subject import SHARE, Subject, chance, curve
from harness.tuning.scoring.alarms import DETECTORS

MOST_POINTS = 150  # of a curve on the page
FAR = 1e3  # [m]: stands for a scan without any return; nearer than everything is its negative
ONE_CLASS = "The scans of the test episodes are all of one class, so there is no curve."

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
    roc_data = [
        chance("chance"),
        *_lines(rocs, "AUC"),
        *_places(subject, "false positive rate", "recall"),
    ]
    pr_data = [guess, *_lines(curves, "AP"), *_places(subject, "recall", "precision")]
    roc_axes, pr_axes = _axes("false positive rate", "true positive rate"), _axes("recall", "precision")
    return {
        "roc": subject.plot("roc", f"ROC of single scans; {_areas(rocs)}", roc_data, *roc_axes),
        "pr": subject.plot("pr", f"precision over recall; {_areas(curves)}", pr_data, *pr_axes),
    }


def has_both_classes(truth: Truth) -> bool:
    """Returns whether there is a curve."""
    return bool(truth.any() and not truth.all())


def roc(score: Values, truth: Truth) -> Curve:
    """Returns false and true positive rate of a score that rises with how sure a detector is."""
    false, true, _ = roc_curve(truth, score)
    return _thinned(false, true, float(roc_auc_score(truth, score)))


def precision_recall(score: Values, truth: Truth) -> Curve:
    """Returns recall and precision, likewise; the area is the average precision."""
    precision, recall, _ = precision_recall_curve(truth, score)
    # The last point, no recall at full precision, is of no threshold.
    return _thinned(recall[-2::-1], precision[-2::-1], float(average_precision_score(truth, score)))


def _thinned(x: Values, y: Values, area: float) -> Curve:
    """Points at even distances along the curve, its ends among them."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
    kept = np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], MOST_POINTS)))
    kept = np.unique(np.concatenate((kept.clip(max=len(x) - 1), [len(x) - 1])))
    return Curve(x[kept], y[kept], area)


def _lines(curves: Mapping[str, Curve], area: str) -> list[Trace]:
    return [
        curve(f"{name}: {area} {one.area:.3f}", one.x, one.y, STYLES[name][0], dash=STYLES[name][1])
        for name, one in curves.items()
    ]


def _places(subject: Subject, x: str, y: str) -> list[Trace]:
    """Every detector at its value, by its measures."""
    return operating_points(
        subject.study.collision, lambda told: (told.scans[x].value, told.scans[y].value)
    )


def _axes(x: str, y: str) -> tuple[Layout, Layout]:
    return titled(x, **SHARE), titled(y, **SHARE)


def _areas(curves: Mapping[str, Curve]) -> str:
    return ", ".join(f"{curve.area:.3f} by {name}" for name, curve in curves.items())
