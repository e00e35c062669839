"""What stands in the tables about runs among people."""

from collections.abc import Iterator, Mapping, Sequence

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.social.comparison import METRICS, Difference, Group
from rover_metrics.analysis.social.metrics import PERSONAL_SPACE, SOON, ZONES, RunFigures
from rover_metrics.sheet.sheet import NONE, Sheet, formatted, interval_text, number, probability

PAIRS_CAPTION = (
    "Windows: each of {goals} goals, logs of a group joined; p: Mann-Whitney U, two-sided; interval: "
    "Welch; d: Cohen's. Runs: each log one observation, the honest sample, since the windows of one run "
    "resemble each other; p: exact permutation (many runs: Mann-Whitney U), two-sided. Holm: adjusted "
    "for the number of pairs, metric by metric. Differences are second minus first."
)


def social_sheets(
    groups: Mapping[str, Group], differences: Sequence[Difference], goals: int, risk_distance: float
) -> Iterator[Sheet]:
    """Yields the tables: runs of each group, groups, their differences.

    Args:
        groups: By name.
        differences: Of pairs of groups; no table if there are none.
        goals: Length of a window.
        risk_distance: How near a person is at risk [m].
    """
    for group in groups.values():
        yield _runs(group, risk_distance)
    yield _groups(groups, goals)
    if differences:
        caption = PAIRS_CAPTION.format(goals=goals)
        yield Sheet.of(map(_pair, differences), "Differences", caption=caption)


def _runs(group: Group, risk_distance: float) -> Sheet:
    shares = f"intimate below {ZONES['intimate']:g} m, personal below {ZONES['personal']:g} m"
    caption = (
        f"Risk: seconds with somebody nearer than {risk_distance:g} m. Zones: share of the seconds with "
        f"the nearest person in each of Hall's, {shares}. Intrusions: times that somebody came nearer "
        f"than {PERSONAL_SPACE:g} m. TTC: distance over closing speed; seconds below {SOON:g} s."
    )
    rows = (
        {"Log": log.path.name, **_run_cells(figures)}
        for log, figures in zip(group.logs, group.figures, strict=True)
    )
    odd = tuple(f"{log.path.name}: {finding}" for log in group.logs for finding in log.findings)
    spare = frozenset({"Intimate", "Personal", "Smallest TTC s"})
    return Sheet.of(rows, f"Runs of {group.name}", caption=caption, findings=odd, spare=spare)


def _run_cells(figures: RunFigures) -> dict[str, str]:
    known = sum(figures.zone_s.values())
    share = {zone: f"{100 * s / known:.1f} %" if known else NONE for zone, s in figures.zone_s.items()}
    return {
        "Seconds": str(figures.seconds),
        "Goals": str(figures.goals),
        "Risk s": str(figures.risk_s),
        "Risk s/goal": number(figures.risk_s_per_goal),
        "s/goal": number(figures.s_per_goal),
        "Nearest m": number(figures.min_distance),
        "Intimate": share["intimate"],
        "Personal": share["personal"],
        "Intrusions": str(figures.intrusions),
        "Smallest TTC s": number(figures.min_time_to_collision),
        "TTC low s": str(figures.closing_s),
    }


def _groups(groups: Mapping[str, Group], goals: int) -> Sheet:
    rows = (
        {
            "Metric, group": f"{title}, {group.name}",
            "Mean of windows": _mean(group.of_windows(metric)),
            "Windows": str(len(group.windows)),
            "Mean of runs": _mean(group.of_runs(metric)),
            "Runs": str(len(group.logs)),
        }
        for metric, title in METRICS.items()
        for group in groups.values()
    )
    caption = f"A window is {goals} goals; a run without a goal has no mean."
    return Sheet.of(rows, "Groups", caption=caption)


def _mean(values: Floats) -> str:
    return number(float(values.mean()) if values.size else None)


def _pair(each: Difference) -> dict[str, str]:
    first, second = each.groups
    by_windows, by_runs = each.windows, each.runs
    return {
        "Metric, groups": f"{METRICS[each.metric]}, {first} and {second}",
        "Difference": number(by_windows.difference),
        "Interval": interval_text(by_windows.interval),
        "d": formatted(each.cohens_d, "+.2f"),
        "p": probability(by_windows.p),
        "p (Holm)": probability(by_windows.p_holm),
        "Difference, runs": number(by_runs.difference),
        "p (Holm), runs": probability(by_runs.p_holm),
        "Lowest p of so few": probability(by_runs.smallest_p),
    }
