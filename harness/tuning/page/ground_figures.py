"""Figures of the two thresholds of roughness: what is felt on smooth and on rough ground."""

import numpy as np

from harness.page.figure import INK, METRIC, TRUTH, Plot, Trace
from harness.tuning.episodes.plan import Part
from harness.tuning.page.curves import Labelled, roc
from harness.tuning.page.episodes import Subject
from harness.tuning.page.traces import SHARE, chance, chosen, figure, levels, line, mark, spelled, titled
from harness.tuning.scoring.ground import GroundStudy
from harness.tuning.scoring.imu_events import Felt, Signal
from harness.tuning.scoring.result import Candidate

BINS, TAIL = 60, 0.99  # the last bin has all that is beyond this quantile
ONE_CLASS = "The checking episodes have ground of one class only, so there is no figure."


def distributions(subject: Subject, study: GroundStudy, signal: Signal) -> Plot | str:
    """How often which value is felt, by class."""
    felt = _felt(subject, signal)
    if not _labelled(felt).has_both_classes:
        return ONE_CLASS
    thresholds = [study.verdict.default, *([study.verdict.tuned] if study.verdict.tuned else [])]
    values = [candidate.value for candidate in thresholds]
    edges = np.linspace(
        min(felt.signal.min(), *values), max(np.quantile(felt.signal, TAIL), *values) * 1.01, BINS + 1
    )
    smooth, rough = (
        100 * np.histogram(felt.signal[of].clip(max=edges[-1]), edges)[0] / np.count_nonzero(of)
        for of in (~felt.rough, felt.rough)
    )
    area = {"fill": "tozeroy", "fillcolor": "--metric-band"}
    data = [
        _steps(f"smooth ground, {np.count_nonzero(~felt.rough)} values", edges, smooth, METRIC) | area,
        _steps(f"rough ground, {np.count_nonzero(felt.rough)} values", edges, rough, TRUTH),
    ]
    x = titled(f"{study.what} [{spelled(study.verdict.unit)}]")
    drawn = figure(data, x, titled("share of the class [%]", rangemode="tozero"), levels(study.verdict))
    return subject.plot(
        f"{study.verdict.name}-classes", f"{study.what} on smooth and rough ground", drawn
    )


def ground_roc(subject: Subject, study: GroundStudy, signal: Signal) -> Plot | str:
    """ROC of the signal, with its thresholds on it."""
    labelled = _labelled(_felt(subject, signal))
    if not labelled.has_both_classes:
        return ONE_CLASS
    curve, auc = roc(labelled), study.auc[Part.CHECKING].text()
    data = [
        chance("chance", (0.0, 1.0), (0.0, 1.0)),
        line(f"AUC {auc}", curve.x, curve.y),
    ]
    if study.verdict.tuned is not None:
        data.append(
            mark(
                f"{chosen(study.verdict)} {study.verdict.tuned.value:g}",
                *_place(study.verdict.tuned),
                METRIC,
                "diamond-open",
            )
        )
    data.append(mark(f"default {study.verdict.default.value:g}", *_place(study.verdict.default), INK))
    axes = titled("smooth ground called rough", **SHARE), titled("rough ground found", **SHARE)
    return subject.plot(f"{study.verdict.name}-roc", f"ROC, AUC {auc}", figure(data, *axes))


def _place(candidate: Candidate) -> tuple[float, float]:
    scores = candidate.scores[Part.CHECKING]
    return 1.0 - scores["smooth ground spared"].value, scores["rough ground found"].value


def _steps(name: str, edges: np.ndarray, heights: np.ndarray, color: str) -> Trace:
    steps = line(name, edges, [*heights, 0.0], color)
    return steps | {"line": steps["line"] | {"shape": "hv"}}


def _felt(subject: Subject, signal: Signal) -> Felt:
    each = [signal.felt(record) for record in subject.checking]
    if not each:
        return Felt(np.empty(0), np.empty(0, dtype=bool), np.empty(0))
    return Felt(
        np.concatenate([felt.signal for felt in each]),
        np.concatenate([felt.rough for felt in each]),
        np.concatenate([felt.speed for felt in each]),
    )


def _labelled(felt: Felt) -> Labelled:
    return Labelled(felt.signal, felt.rough)
