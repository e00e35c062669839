"""Figures of single scans and seconds: what the samples say by class of the truth, and of steps."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sklearn.metrics import average_precision_score, precision_recall_curve, roc_auc_score, roc_curve

from harness.page.figure import METRIC, MUTED, SCAN, TRUTH, Plot, Trace, titled
from harness.tune.episodes.plan import Part
from harness.tune.page.contact_figures import STYLES, Values, operating_points
from harness.tune.page.subject import SHARE, Subject, chance, chosen, curve, levels, mark, upright
from harness.tune.scoring.alarms import DETECTORS
from harness.tune.scoring.choose import Candidate
from harness.tune.scoring.ground import SIGNALS, GroundStudy, ImuEvents
from rover_metrics.sheet.sheet import spelled

MOST_POINTS = 150  # of a curve on the page
FAR = 1e3  # [m]: stands for a scan without any return; nearer than everything is its negative
ONE_CLASS = "The scans of the test episodes are all of one class, so there is no curve."
# What each shows, the area under a curve, the measures on its axes, and the title of the second axis.
FIGURES = {
    "roc": ("ROC of single scans", "AUC", "false positive rate", "recall", "true positive rate"),
    "pr": ("precision over recall", "AP", "recall", "precision", "precision"),
}
BINS, TAIL = 60, 0.99  # the last bin has all that is beyond this quantile
ONE_GROUND = "The test episodes have ground of one class only, so there is no figure."
NO_SECONDS = "No second of poses in the test episodes, so there is no figure."
SHORTEST, LONGEST = 1e-3, 30.0  # [m] of the axis of steps
QUANTILES = np.linspace(0.0, 1.0, 201)
STEPS = (
    ("largest_step", "longest step of a second", METRIC, "solid"),
    ("largest_stride", "the same with four poses lost", SCAN, "dash"),
    ("from_start", "jump of a reset at its end", TRUTH, "dashdot"),
)

Truth = NDArray[np.bool_]


class Curve(NamedTuple):
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


def ground_figures(subject: Subject) -> dict[str, Plot | str]:
    """Returns figures of each signal on smooth and rough ground by name, or why there are none."""
    figures: dict[str, Plot | str] = {}
    for study, signal in zip(subject.study.grounds, SIGNALS, strict=True):
        events = ImuEvents.joined([signal.imu_events(record) for record in subject.test])
        both = has_both_classes(events.rough)
        for name, draw in (("classes", _distributions), ("roc", _roc)):
            figures[f"{signal.parameter}-{name}"] = draw(subject, study, events) if both else ONE_GROUND
    return figures


def _distributions(subject: Subject, study: GroundStudy, events: ImuEvents) -> Plot:
    """How often the signal has which value on smooth and on rough ground."""
    verdict = study.verdict
    values = [candidate.value for candidate in (verdict.default, verdict.tuned) if candidate]
    low, high = min(events.signal.min(), *values), max(np.quantile(events.signal, TAIL), *values)
    edges = np.linspace(low, high * 1.01, BINS + 1)
    smooth = _histogram("smooth ground", events.signal[~events.rough], edges, METRIC)
    rough = _histogram("rough ground", events.signal[events.rough], edges, TRUTH)
    area = {"fill": "tozeroy", "fillcolor": "--metric-band"}
    x = titled(f"{study.what} [{spelled(verdict.unit)}]")
    y = titled("share of the class [%]", rangemode="tozero")
    name, summary = f"{verdict.name}-classes", f"{study.what} on smooth and rough ground"
    return subject.plot(name, summary, [smooth | area, rough], x, y, levels(verdict))


def _roc(subject: Subject, study: GroundStudy, events: ImuEvents) -> Plot:
    """The ROC of the signal with its thresholds on it."""
    drawn, auc, verdict = roc(events.signal, events.rough), study.auc[Part.TEST].text(), study.verdict
    data = [chance("chance"), curve(f"AUC {auc}", drawn.x, drawn.y)]
    if verdict.tuned is not None:
        name = f"{chosen(verdict)} {verdict.tuned.value:g}"
        data.append(mark(name, *_place(verdict.tuned), tuned=METRIC))
    data.append(mark(f"default {verdict.default.value:g}", *_place(verdict.default)))
    axes = titled("1 \N{MINUS SIGN} specificity", **SHARE), titled("recall of rough ground", **SHARE)
    return subject.plot(f"{verdict.name}-roc", f"ROC, AUC {auc}", data, *axes)


def steps_and_jumps(subject: Subject) -> Plot | str:
    """Returns cumulative distributions over the seconds of the test episodes, or why there are none."""
    study = subject.study.distance
    if not any(len(record.windows) for record in subject.test):
        return NO_SECONDS
    windows = np.concatenate([record.windows for record in subject.test])
    data = [
        curve(name, np.quantile(windows[of], QUANTILES).clip(SHORTEST), QUANTILES, color, dash=dash)
        for of, name, color, dash in STEPS
    ]
    name = f"{study.possible_step:.3f} m: four poses lost at top speed"
    lines = [upright(name, study.possible_step, "solid", MUTED), *levels(study.verdict)]
    x = titled("distance [m]", type="log", range=np.log10([SHORTEST, LONGEST]).tolist())
    y = titled("share of seconds below", **SHARE)
    summary = (
        f"steps up to {study.largest_step:.3f} m, {study.largest_stride:.3f} m with four poses lost"
    )
    return subject.plot("steps", summary, data, x, y, lines)


def _histogram(name: str, values: NDArray[np.float64], edges: NDArray[np.float64], color: str) -> Trace:
    """Returns the share of the values in each bin as a step curve [%]."""
    heights = 100 * np.histogram(values.clip(max=edges[-1]), edges)[0] / len(values)
    return curve(f"{name}, {len(values)} values", edges, [*heights, 0.0], color, shape="hv")


def _place(candidate: Candidate) -> tuple[float, float]:
    scores = candidate.scores[Part.TEST]
    return 1.0 - scores["specificity"].value, scores["recall"].value
