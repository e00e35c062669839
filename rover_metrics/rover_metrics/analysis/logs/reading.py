"""A file to a Log: what is usable of it, where its episodes begin, and what was odd."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from rover_metrics.analysis.logs import findings as odd
from rover_metrics.analysis.logs.header import UnreadableLog, read_header
from rover_metrics.analysis.logs.log import DEFAULT_GAP, Floats, Integers, Log
from rover_metrics.analysis.logs.parsing import Table, Tally, read_table
from rover_metrics.analysis.metric import COUNTERS, FLAGS, METRICS, STAMP, Metric
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS
from rover_metrics.errors import counted
from rover_metrics.log import session_record as record


def read_log(
    path: Path, metrics: Sequence[Metric] = tuple(METRICS.values()), gap: float = DEFAULT_GAP
) -> Log:
    """Returns a metrics log; it has at least one row.

    Args:
        path: The file.
        metrics: Only their columns are kept, and the counters, which separate the episodes.
        gap: Longest time between two rows of one episode [s].

    Raises:
        UnreadableLog: The file is missing, is no metrics log, or has no usable row.
    """
    header = read_header(path)
    columns = (column for m in metrics for column in (*m.columns, m.extended_column))
    needed = dict.fromkeys([*COUNTERS, *filter(None, columns)])  # a column without a name is none
    checked = dict.fromkeys([*needed, *odd.CHECKED_COLUMNS])
    table = read_table(path, header, [name for name in checked if header.count(name) == 1])
    if not any(metric.column in header for metric in metrics):
        raise UnreadableLog(f"it has no column for {', '.join(metric.code for metric in metrics)}")
    _check_usable(table, header)
    findings = odd.describe_table(table, header, metrics)
    rows = _without_wrong_flags(table.rows, findings)
    thresholds = record.session_thresholds(path)
    findings += odd.describe_consistency(rows, thresholds or DEFAULT_THRESHOLDS)
    findings += odd.describe_time(rows, gap)
    if record.session_end(path) is (unmarked := record.SessionEnd.UNMARKED):
        findings.append(f"the session has no end mark: {unmarked.value}")
    # Of consecutive rows with one time the last counts: its counters are up to date.
    rows = rows[np.append(np.diff(rows[STAMP]) != 0, True)]
    stamps = rows[STAMP].to_numpy()
    values = {name: rows[name].to_numpy() for name in needed if name in table.cells}
    starts = episode_starts(stamps, [values[name] for name in COUNTERS if name in values], gap)
    arguments = record.session_arguments(path)
    return Log(path, stamps, values, starts, tuple(findings), thresholds, arguments)


def _check_usable(table: Table, header: Sequence[str]) -> None:
    for tally, how_many in ((table.long, "more"), (table.short, "fewer")):
        if tally.count > table.total / 2 and table.total > 1:
            raise UnreadableLog(
                f"mixed schemas: the header names {len(header)} columns, but {tally.count} of "
                f"{table.total} rows have {how_many} fields (first on line {tally.first})"
            )
    if table.rows.empty:
        why = " with a number for a Timestamp" if table.untimed.count == table.total else ""
        rows = counted(table.total, "row")
        raise UnreadableLog(f"no usable row{why} among {rows} (line 2 is the first)")


def _without_wrong_flags(rows: pd.DataFrame, findings: list[str]) -> pd.DataFrame:
    """Silences flags that are neither 0 nor 1, and adds what there is to say of it."""
    for name in filter(set(rows).__contains__, FLAGS):
        wrong, tally = rows[name].notna() & ~rows[name].isin([0, 1]), Tally()
        tally.add(rows.index[wrong])
        findings += tally.describe("value", f" of {name} other than 0 and 1")
        if tally.count:
            rows = rows.assign(**{name: rows[name].mask(wrong)})
    return rows


def episode_starts(
    stamps: Floats, counters: Iterable[NDArray[np.floating]], gap: float = DEFAULT_GAP
) -> Integers:
    """Returns the first row of each episode, ascending; the first is 0.

    An episode begins where the time goes back (the simulation was reset), where it leaps by more
    than a gap, or where a counter falls (the node was restarted).

    Args:
        stamps: Time of each row [s], at least one row.
        counters: Columns that only grow within an episode; NaN is skipped.
        gap: Longest time between two rows of one episode [s].
    """
    steps = np.diff(stamps)
    begins = np.concatenate(([True], (steps < 0) | (steps > gap)))
    for counter in counters:
        known = np.flatnonzero(np.isfinite(counter))
        begins[known[1:][np.diff(counter[known]) < 0]] = True
    return np.flatnonzero(begins)
