"""The key curve of a tuning as a picture: F1 over collision_threshold, a panel per robot."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from harness.files import whole_file
from harness.tuning.episodes.plan import Part, Planned
from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.page.curves import event_intervals, event_scores
from harness.tuning.page.episodes import Subject, subject
from harness.tuning.page.traces import chosen
from harness.tuning.scoring.alarms import DETECTORS
from harness.tuning.scoring.collision import GRID, SEEDS_DETECTOR
from harness.tuning.scoring.estimate import Estimate
from harness.tuning.scoring.result import Candidate
from harness.tuning.scoring.study import RobotStudy

SIZE, DPI = (6.4, 3.9), 100.0  # [in] of a panel
BLUE, GREY, INK = "#0072b2", "#8c959f", "#1b1f24"  # as on the page


def draw_picture(
    studies: Sequence[RobotStudy], records: Mapping[Planned, EpisodeRecord], target: Path
) -> None:
    """Writes the picture as PNG, there whole or not at all; the same studies give the same bytes.

    Args:
        studies: One per robot.
        records: All episodes that they were made from.
        target: Where it goes.
    """
    figure = Figure(figsize=(SIZE[0] * len(studies), SIZE[1]), dpi=DPI, layout="constrained")
    panels = figure.subplots(1, len(studies), sharey=True, squeeze=False)[0]
    for axes, study in zip(panels, studies, strict=True):
        _draw(axes, subject(study, records))
    panels[0].set_ylabel("F1 of alarms and contacts")
    with whole_file(target) as part:
        figure.savefig(part, format="png", metadata={"Software": None})


def _draw(axes: Axes, robot: Subject) -> None:
    detector, verdict = DETECTORS[SEEDS_DETECTOR], robot.study.collision.verdict
    intervals = event_intervals(detector, robot.checking, GRID, "F1")
    low, high = ([np.nan if end is None else end for end in ends] for ends in _ends(intervals))
    axes.fill_between(GRID, low, high, color=BLUE, alpha=0.2, lw=0, label="95 % interval")
    seen, unseen = (event_scores(detector, robot.records[part], GRID)["F1"] for part in Part)
    axes.plot(GRID, seen, color=GREY, ls="-.", lw=1.2, label="episodes it was chosen on")
    axes.plot(GRID, unseen, color=BLUE, lw=2.0, label="unseen seeds")
    _mark(axes, verdict.default, "default", "o", ":")
    if verdict.tuned is not None:
        _mark(axes, verdict.tuned, chosen(verdict), "D", "--")
    axes.set(title=robot.robot, xlabel="collision_threshold [m]", xlim=(0.0, GRID[-1]), ylim=(0.0, 1.0))
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="#e3e7eb")
    axes.set_axisbelow(True)
    axes.legend(loc="lower right", frameon=False)


def _ends(intervals: Sequence[Estimate]) -> tuple[list[float | None], list[float | None]]:
    return [found.low for found in intervals], [found.high for found in intervals]


def _mark(axes: Axes, candidate: Candidate, name: str, symbol: str, dash: str) -> None:
    score = candidate.scores[Part.CHECKING]["F1"]
    axes.axvline(candidate.value, color=INK, ls=dash, lw=1.0)
    axes.plot(
        [candidate.value],
        [score.value],
        symbol,
        ms=8,
        mfc="white",
        mec=INK,
        mew=1.8,
        ls=dash,
        color=INK,
        label=f"{name} {candidate.value:g} m: {score.text()}",
    )
