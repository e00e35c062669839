"""What was odd about a file, one line each, with the line of the file where it was met first."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rover_metrics.analysis.logs.table import Table, Tally
from rover_metrics.analysis.metric import METRIC_COLUMNS, Metric

_UNIX_TIME = 1e9  # s; a simulation does not run for 30 years
_LATE = 1.5  # periods between two rows beyond which one is missing


def describe_table(table: Table, header: Sequence[str], metrics: Sequence[Metric]) -> list[str]:
    """Say what was not usable of a file."""
    absent = [name for name in METRIC_COLUMNS if name not in header]
    codes = [metric.code for metric in metrics if not set(metric.columns).isdisjoint(absent)]
    findings = []
    if codes:
        findings.append(f"{len(header)} columns, without {', '.join(absent)}: no {', '.join(codes)}")
    if table.spaces:
        findings.append("spaces before numbers")
    too_long = "with more fields than the header, so which is which is unclear"
    findings += _left_out(table.long, ("row", "rows"), too_long)
    findings += _left_out(table.short, ("row", "rows"), "with fewer fields than the header")
    findings += _left_out(table.untimed, ("row", "rows"), "without a number for a Timestamp")
    for name, tally in table.cells.items():
        findings += _left_out(tally, ("cell", "cells"), f"without a number in {name}")
    for name, tally in table.infinite.items():
        why = f"in {name}, as before the first scan" if name == "Obstacle Clearance" else f"in {name}"
        findings += _left_out(tally, ("infinite value", "infinite values"), why)
    return findings


def describe_time(table: Table, gap: float) -> list[str]:
    """Say what was odd about the times of the rows; episodes begin where `gap` is exceeded."""
    steps = np.diff(table.stamps)
    if not steps.size:
        return ["a single row: no rate, no interval"]
    period = float(np.median(steps[steps > 0])) if (steps > 0).any() else 1.0
    late = (steps > _LATE * period) & (steps <= gap)
    longest = f"up to {steps[late].max(initial=0):g} s, rates are over the time that passed"
    findings = [
        *_seen(steps == 0, table, "duplicate timestamp", "the later row counts"),
        *_seen(steps < 0, table, "backward timestamp", "an episode begins there"),
        *_seen(steps > gap, table, "long gap", f"over {gap:g} s, an episode begins there"),
        *_seen(late, table, "short gap", longest),
    ]
    if abs(period - 1.0) > 0.01:
        findings.append(f"a row every {period:g} s, not every second")
    if table.stamps[0] > _UNIX_TIME:
        findings.append("wall-clock timestamps: the node ran without use_sim_time")
    return findings


def _left_out(tally: Tally, noun: tuple[str, str], what: str) -> list[str]:
    if not tally.count:
        return []
    example = f", {tally.example}" if tally.example else ""
    return [f"{tally.count} {noun[tally.count > 1]} {what} ({_where(tally)}{example}): left out"]


def _seen(steps: NDArray[np.bool_], table: Table, noun: str, what: str) -> list[str]:
    tally = Tally()
    tally.add(table.lines[1:][steps])
    if not tally.count:
        return []
    return [f"{tally.count} {noun}{'s' if tally.count > 1 else ''} ({_where(tally)}): {what}"]


def _where(tally: Tally) -> str:
    return f"line {tally.first}" if tally.count == 1 else f"first on line {tally.first}"
