"""Groups of runs among people, and whether two of them differ.

Each pair of groups is compared twice. By its windows, as RoboTerrain's published tables: Mann-Whitney
U, Welch's interval and Cohen's d. And by its runs, each one observation: an exact permutation test; the
windows of one run resemble each other, so the runs are the honest sample. Each p is
adjusted for the number of pairs (Holm), metric by metric.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import scipy  # loads a part of it when that is named

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.social.log import SocialLog
from rover_metrics.analysis.social.metrics import RISK_DISTANCE, WINDOW_GOALS, RunFigures, run_figures
from rover_metrics.analysis.social.metrics import windows as windows_of
from rover_metrics.analysis.statistics.comparison import Comparison, cohens_d, compare, with_holm

METRICS = {"risk_s_per_goal": "Risk seconds a goal", "s_per_goal": "Seconds a goal"}


@dataclass(frozen=True, eq=False)
class Group:
    """The runs of one condition, with the figures of each."""

    name: str
    logs: tuple[SocialLog, ...]
    figures: tuple[RunFigures, ...]
    windows: Floats  # risk seconds and seconds for a goal of each, shape (windows, 2)

    def of_windows(self, metric: str) -> Floats:
        """Returns a metric's value of each window."""
        return self.windows[:, list(METRICS).index(metric)]

    def of_runs(self, metric: str) -> Floats:
        """Returns a metric's value of each run that reached a goal."""
        values = [getattr(figures, metric) for figures in self.figures]
        return np.array([value for value in values if value is not None])


@dataclass(frozen=True)
class Difference:
    """How the second of two groups differs from the first in one metric."""

    metric: str  # of METRICS
    groups: tuple[str, str]
    windows: Comparison  # by windows; its test is Mann-Whitney's
    cohens_d: float | None  # of the windows: the difference in pooled standard deviations
    runs: Comparison  # by runs


def make_group(
    name: str, logs: Sequence[SocialLog], goals: int = WINDOW_GOALS, risk_distance: float = RISK_DISTANCE
) -> Group:
    """Returns a group of logs.

    Args:
        name: As the tables show it.
        logs: One per run.
        goals: Length of a window.
        risk_distance: How near a person is at risk [m].
    """
    figures = tuple(run_figures(log, risk_distance) for log in logs)
    return Group(name, tuple(logs), figures, windows_of(logs, goals, risk_distance))


def differences(groups: Mapping[str, Group], confidence: float) -> list[Difference]:
    """Returns each pair of groups, metric by metric; the first of a pair is the earlier one.

    Intervals are of the given confidence, between 0 and 1.
    """
    all_pairs: list[Difference] = []
    for metric in METRICS:
        pairs = [_difference(metric, *pair, confidence) for pair in combinations(groups.values(), 2)]
        by_windows = with_holm([pair.windows for pair in pairs])
        by_runs = with_holm([pair.runs for pair in pairs])
        all_pairs += [
            replace(pair, windows=of_windows, runs=of_runs)
            for pair, of_windows, of_runs in zip(pairs, by_windows, by_runs, strict=True)
        ]
    return all_pairs


def _difference(metric: str, first: Group, second: Group, confidence: float) -> Difference:
    a, b = first.of_windows(metric), second.of_windows(metric)
    by_windows = compare(metric, a, b, confidence)
    enough = min(a.size, b.size) >= 2
    if enough:
        p = float(scipy.stats.mannwhitneyu(b, a).pvalue)
        by_windows = replace(by_windows, test="Mann-Whitney U", p=p, smallest_p=None)
    return Difference(
        metric=metric,
        groups=(first.name, second.name),
        windows=by_windows,
        cohens_d=cohens_d(a, b) if enough else None,
        runs=compare(metric, first.of_runs(metric), second.of_runs(metric), confidence),
    )
