"""Figures of the thresholds of roughness and of steps: what the samples say by class of the truth."""

import numpy as np
from numpy.typing import NDArray

from harness.page.figure import METRIC, MUTED, SCAN, TRUTH, Plot, Trace, spelled, titled
from harness.tune.episodes.plan import Part
from harness.tune.page.scan_figures import has_both_classes, roc
from harness.tune.page.subject import SHARE, Subject, chance, chosen, curve, levels, mark, upright
from harness.tune.scoring.ground import GroundStudy
from harness.tune.scoring.imu_events import SIGNALS, ImuEvents
from harness.tune.scoring.result import Candidate

BINS, TAIL = 60, 0.99  # the last bin has all that is beyond this quantile
ONE_CLASS = "The test episodes have ground of one class only, so there is no figure."
NO_SECONDS = "No second of poses in the test episodes, so there is no figure."
SHORTEST, LONGEST = 1e-3, 30.0  # [m] of the axis of steps
QUANTILES = np.linspace(0.0, 1.0, 201)
STEPS = (
    ("largest_step", "longest step of a second", METRIC, "solid"),
    ("largest_stride", "the same with four poses lost", SCAN, "dash"),
    ("from_start", "jump of a reset at its end", TRUTH, "dashdot"),
)


def ground_figures(subject: Subject) -> dict[str, Plot | str]:
    """Returns figures of each signal on smooth and rough ground by name, or why there are none."""
    figures: dict[str, Plot | str] = {}
    for study, signal in zip(subject.study.grounds, SIGNALS, strict=True):
        events = ImuEvents.joined([signal.imu_events(record) for record in subject.test])
        both = has_both_classes(events.rough)
        for name, draw in (("classes", _distributions), ("roc", _roc)):
            figures[f"{signal.parameter}-{name}"] = draw(subject, study, events) if both else ONE_CLASS
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
