"""Figures of single scans: ROC and precision over recall of every detector."""

from harness.page.figure import Plot, Trace
from harness.tuning.page.curves import Curve, precision_recall, roc, scans
from harness.tuning.page.detectors import STYLES, operating_points
from harness.tuning.page.episodes import Subject
from harness.tuning.page.traces import SHARE, chance, figure, line, titled
from harness.tuning.scoring.alarms import DETECTORS
from harness.tuning.scoring.collision import SEEDS_DETECTOR

ONE_CLASS = "The scans of the checking episodes are all of one class, so there is no curve."


def scan_roc(subject: Subject) -> Plot | str:
    """True over false positive rate."""
    if not _has_both_classes(subject):
        return ONE_CLASS
    curves = {name: roc(scans(detector, subject.checking)) for name, detector in DETECTORS.items()}
    data = [
        chance("chance", (0.0, 1.0), (0.0, 1.0)),
        *_lines(curves, "AUC"),
        *operating_points(
            subject.study.collision,
            lambda told: (told.scans["false positive rate"].value, told.scans["recall"].value),
        ),
    ]
    axes = titled("false positive rate", **SHARE), titled("true positive rate", **SHARE)
    return subject.plot("roc", f"ROC of single scans; {_areas(curves)}", figure(data, *axes))


def scan_precision_recall(subject: Subject) -> Plot | str:
    """Precision over recall."""
    if not _has_both_classes(subject):
        return ONE_CLASS
    labelled = {name: scans(detector, subject.checking) for name, detector in DETECTORS.items()}
    curves = {name: precision_recall(scan) for name, scan in labelled.items()}
    share = float(labelled[SEEDS_DETECTOR].truth.mean())
    data = [
        chance(f"chance: {100 * share:.1f} % of all scans", (0.0, 1.0), (share, share)),
        *_lines(curves, "AP"),
        *operating_points(
            subject.study.collision,
            lambda told: (told.scans["recall"].value, told.scans["precision"].value),
        ),
    ]
    axes = titled("recall", **SHARE), titled("precision", **SHARE)
    return subject.plot("pr", f"precision over recall; {_areas(curves)}", figure(data, *axes))


def _has_both_classes(subject: Subject) -> bool:
    return scans(DETECTORS[SEEDS_DETECTOR], subject.checking).has_both_classes


def _lines(curves: dict[str, Curve], area: str) -> list[Trace]:
    return [
        line(f"{name}: {area} {curve.area:.3f}", curve.x, curve.y, STYLES[name][0], dash=STYLES[name][1])
        for name, curve in curves.items()
    ]


def _areas(curves: dict[str, Curve]) -> str:
    return ", ".join(f"{curve.area:.3f} by {name}" for name, curve in curves.items())
