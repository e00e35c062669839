"""What was odd about a file, one line each, with the line of the file where it was met first."""

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from rover_metrics.analysis.logs.parsing import Table, Tally
from rover_metrics.analysis.metric import (
    CLEARANCE,
    COUNTERS,
    METRIC_COLUMNS,
    STAMP,
    Metric,
    is_other,
)

_UNIX_TIME = 1e9  # s; a simulation does not run for 30 years
_MOST_NAMED = 4  # columns that are not there
_LATE = 1.5  # periods between two rows beyond which one is missing


def describe_table(table: Table, header: Sequence[str], metrics: Sequence[Metric]) -> list[str]:
    """Returns what was not usable of a file."""
    asked = {column for metric in metrics for column in (*metric.columns, metric.extended_column)}
    findings = [*_absent(header, metrics)]
    if table.spaces:
        findings.append("spaces before numbers")
    too_long = " with more fields than the header, so which is which is unclear"
    findings += _described(table.long, "row", too_long)
    findings += _described(table.short, "row", " with fewer fields than the header")
    findings += _described(table.untimed, "row", " without a number for a Timestamp")
    for name, tally in table.cells.items():
        if name in asked or name in COUNTERS:
            findings += _described(tally, "cell", f" without a number in {name}")
    for name, tally in table.infinite.items():
        when = ", as before the first scan" if name == CLEARANCE else ""
        if name in asked or name in COUNTERS:
            findings += _described(tally, "infinite value", f" in {name}{when}")
    return findings


def describe_time(rows: pd.DataFrame, gap: float) -> list[str]:
    """Returns what was odd about the times of a table's rows; a longer gap [s] begins an episode."""
    steps = np.diff(rows[STAMP])
    if not steps.size:
        return ["a single row: no rate, no interval"]
    period = float(np.median(steps[steps > 0])) if (steps > 0).any() else 1.0
    late = (steps > _LATE * period) & (steps <= gap)
    longest = f"up to {steps[late].max(initial=0):g} s, rates are over the time that passed"
    findings = []
    for odd, noun, outcome in (
        (steps == 0, "duplicate timestamp", "the later row counts"),
        (steps < 0, "backward timestamp", "an episode begins there"),
        (steps > gap, "long gap", f"over {gap:g} s, an episode begins there"),
        (late, "short gap", longest),
    ):
        tally = Tally()
        tally.add(rows.index[1:][odd])
        findings += _described(tally, noun, outcome=outcome)
    if abs(period - 1.0) > 0.01:
        findings.append(f"a row every {period:g} s, not every second")
    if rows[STAMP].iloc[0] > _UNIX_TIME:
        findings.append("wall-clock timestamps: the node ran without use_sim_time")
    return findings


def _absent(header: Sequence[str], metrics: Sequence[Metric]) -> Iterator[str]:
    """Describes the columns that are not there, if a metric asked for needs them."""
    absent = [name for name in METRIC_COLUMNS if name not in header]
    codes = [metric.code for metric in metrics if not set(metric.columns).isdisjoint(absent)]
    if codes:
        yield f"{len(header)} columns, without {', '.join(absent)}: no {', '.join(codes)}"
    others = [metric.column for metric in metrics if is_other(metric.column)]
    lacking = [name for name in others if name not in header]
    if lacking:
        more = f" and {len(lacking) - _MOST_NAMED} more" if len(lacking) > _MOST_NAMED else ""
        yield f"no column {', '.join(lacking[:_MOST_NAMED])}{more}"


def _described(tally: Tally, noun: str, what: str = "", outcome: str = "left out") -> list[str]:
    return [tally.describe(noun, what, outcome)] if tally.count else []
