"""What was odd about a file, one line each, with the line of the file where it was met first.

Also whether its columns agree with each other, as they do if the node counts as it should.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from rover_metrics.analysis import metric as of
from rover_metrics.analysis.logs.parsing import Table, Tally
from rover_metrics.analysis.metric import SMOOTHNESS, SMOOTHNESS_SUM, STAMP, Metric
from rover_metrics.core.metrics import WINDOW
from rover_metrics.core.thresholds import THRESHOLD_INFO, Thresholds

_UNIX_TIME = 1e9  # s; a simulation does not run for 30 years
_MOST_NAMED = 4  # columns that are not there
_LATE = 1.5  # periods between two rows beyond which one is missing
_ROUNDING = 1e-4  # of a log's four decimals, twice over
_FEWEST_TELLING = 10  # rows: that as many quotients are whole by chance is ruled out
_LARGEST_ERROR = 0.1  # of a quotient, beyond which being whole says nothing


def describe_table(table: Table, header: Sequence[str], metrics: Sequence[Metric]) -> list[str]:
    """Returns what was not usable of a file, a line each.

    Args:
        table: What was read of it.
        header: Names of its columns.
        metrics: Only columns that these or counters need are looked at.
    """
    asked = {*of.COUNTERS, *(name for each in metrics for name in (*each.columns, each.extended_column))}
    findings = [*_absent(header, metrics), *(["spaces before numbers"] if table.spaces else [])]
    too_long = " with more fields than the header, so which is which is unclear"
    findings += table.long.describe("row", too_long)
    findings += table.blank.describe("blank line")
    findings += table.short.describe("row", " with fewer fields than the header")
    findings += table.untimed.describe("row", " without a number for a Timestamp")
    for name in filter(asked.__contains__, table.cells):
        findings += table.cells[name].describe("cell", f" without a number in {name}")
    for name in filter(asked.__contains__, table.infinite):
        when = ", as before anything came into range" if name == of.CLEARANCE else ""
        findings += table.infinite[name].describe("infinite value", f" in {name}{when}")
    return findings


def describe_time(rows: pd.DataFrame, gap: float) -> list[str]:
    """Returns what was odd about the times of a table's rows; a longer gap [s] begins an episode."""
    steps = np.diff(rows[STAMP])
    if not steps.size:
        return ["a single row: no rate, no interval"]
    period = float(np.median(steps[steps > 0])) if (steps > 0).any() else 1.0
    late = (steps > _LATE * period) & (steps <= gap)
    longest = f"up to {steps[late].max(initial=0):g} s, rates are over the time that passed"
    findings: list[str] = []
    for odd, noun, outcome in (
        (steps == 0, "duplicate timestamp", "the later row counts"),
        (steps < 0, "backward timestamp", "an episode begins there"),
        (steps > gap, "long gap", f"over {gap:g} s, an episode begins there"),
        (late, "short gap", longest),
    ):
        tally = Tally()
        tally.add(rows.index[1:][odd])
        findings += tally.describe(noun, outcome=outcome)
    if abs(period - 1.0) > 0.01:
        findings.append(f"a row every {period:g} s, not every second")
    if rows[STAMP].iloc[0] > _UNIX_TIME:
        findings.append("wall-clock timestamps: of a real robot, or the node ran without use_sim_time")
    return findings


def _absent(header: Sequence[str], metrics: Sequence[Metric]) -> Iterator[str]:
    """Describes the columns that are not there, if a metric asked for needs them."""
    absent = [name for name in of.METRIC_COLUMNS if name not in header]
    codes = [metric.code for metric in metrics if not set(metric.columns).isdisjoint(absent)]
    if codes:
        yield f"{len(header)} columns, without {', '.join(absent)}: no {', '.join(codes)}"
    others = (metric.column for metric in metrics if of.is_other(metric.column))
    lacking = [name for name in others if name not in header]
    if lacking:
        more = f" and {len(lacking) - _MOST_NAMED} more" if len(lacking) > _MOST_NAMED else ""
        yield f"no column {', '.join(lacking[:_MOST_NAMED])}{more}"


class _Flag(NamedTuple):
    """A flag, the column it is drawn from, and the threshold beyond which it is 1."""

    column: str
    level: str
    threshold: str
    sign: int  # 1 if it is 1 above the threshold, -1 if below


_FLAGS = (
    _Flag(of.COLLISION, of.CLEARANCE, "collision_threshold", -1),
    _Flag(of.ROUGH, of.ACCELERATION, "rough_terrain_threshold", 1),
)
CHECKED_COLUMNS = (*(name for flag in _FLAGS for name in (flag.column, flag.level)), SMOOTHNESS)


def describe_consistency(rows: pd.DataFrame, thresholds: Thresholds) -> list[str]:
    """Returns what contradicts itself in the rows of a log that was made with these thresholds.

    Rows are by line, with what the log has of CHECKED_COLUMNS and of the sum of smoothness.
    """
    flags = [flag for flag in _FLAGS if {flag.column, flag.level} <= set(rows)]
    findings: list[str] = []
    for flag in flags:
        findings += _contradiction(rows, flag, getattr(thresholds, flag.threshold))
    if {SMOOTHNESS, SMOOTHNESS_SUM} <= set(rows) and _is_mean_since_start(rows):
        findings.append(
            f"{SMOOTHNESS} is the mean since the start, as RoboTerrain's node writes it since 2025 "
            f"(its buffer is never trimmed), not of the last {WINDOW} samples"
        )
    return findings


def _contradiction(rows: pd.DataFrame, flag: _Flag, threshold: float) -> list[str]:
    """Describes the rows whose flag is not what their level says; at the threshold it may be either."""
    known = rows[rows[flag.column].notna() & rows[flag.level].notna()]
    is_on, level = known[flag.column] == 1, known[flag.level].astype(np.float64)
    beyond = flag.sign * (level - threshold)
    wrong = known[(np.abs(beyond) > _ROUNDING) & (is_on != (beyond > 0))]
    if wrong.empty:
        return []
    tally = Tally()
    tally.add(wrong.index, f"{wrong[flag.column].iloc[0]:g} at {wrong[flag.level].iloc[0]:g}")
    unit = THRESHOLD_INFO[flag.threshold].unit
    oddity = f" whose {flag.column} contradicts {flag.level} and {flag.threshold} {threshold:g} {unit}"
    fit = _fitting(flag.sign * level[is_on], flag.sign * level[~is_on], flag.sign)
    return tally.describe("row", oddity, f"another rule or threshold was at work{fit}")


def _fitting(on: "pd.Series[float]", off: "pd.Series[float]", sign: int) -> str:
    """Returns which thresholds would explain all flags; levels are multiplied by the flag's sign."""
    if not off.empty and not on.empty and off.max() >= on.min():
        return ""
    ends = sorted(sign * end for end in (off.max(), on.min()) if np.isfinite(end))
    if len(ends) == 2:
        return f", such as one between {ends[0]:g} and {ends[1]:g}"
    side = "below" if off.empty == (sign == 1) else "above"
    return f", such as one {side} {ends[0]:g}"


def _is_mean_since_start(rows: pd.DataFrame) -> bool:
    """Whether the sum over the mean is a whole number in each row: that of all samples so far.

    While a rover is at rest a window has the same mean; so the shaking must have varied.
    """
    mean, total = (rows[name].to_numpy(np.float64) for name in (SMOOTHNESS, SMOOTHNESS_SUM))
    with np.errstate(divide="ignore", invalid="ignore"):
        samples = total / mean
        error = samples * _ROUNDING / mean
    telling = (samples > 1.5 * WINDOW) & (error < _LARGEST_ERROR)
    samples, total, error = samples[telling], total[telling], error[telling]
    if samples.size < _FEWEST_TELLING or np.any(np.abs(samples - np.round(samples)) > error):
        return False
    grows = np.diff(samples) > 0.5
    steps = np.diff(total)[grows] / np.diff(samples)[grows]
    return bool(steps.size and np.ptp(steps) > 0.01 * steps.mean())
