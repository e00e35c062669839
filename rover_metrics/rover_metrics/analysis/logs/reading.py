"""A file to a Log: what is usable of it, where its episodes begin, and what was odd."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rover_metrics.analysis.logs.episodes import DEFAULT_GAP, episode_starts
from rover_metrics.analysis.logs.findings import describe_table, describe_time
from rover_metrics.analysis.logs.header import UnreadableLog, read_header
from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.logs.parsing import read_table
from rover_metrics.analysis.logs.table import Table
from rover_metrics.analysis.metric import COUNTERS, FLAGS, METRICS, Metric
from rover_metrics.log.session_record import SessionEnd, session_end, session_thresholds


def read_log(
    path: Path, metrics: Sequence[Metric] = tuple(METRICS.values()), gap: float = DEFAULT_GAP
) -> Log:
    """Read a metrics log.

    Args:
        path: The file.
        metrics: Only their columns are kept, and the counters, which tell the episodes.
        gap: Longest time between two rows of one episode [s].

    Returns:
        The log; it has at least one row.

    Raises:
        UnreadableLog: The file is missing, is no metrics log, or has no usable row.
    """
    header = read_header(path)
    columns = (column for m in metrics for column in (*m.columns, m.extended_column))
    needed = dict.fromkeys([*COUNTERS, *columns])
    table = read_table(path, header, [name for name in needed if name in header])
    if not any(metric.column in header for metric in metrics):
        raise UnreadableLog(f"it has no column for {', '.join(metric.code for metric in metrics)}")
    _check_usable(table, header)
    findings = describe_table(table, header, metrics)
    findings += _drop_wrong_flags(table)
    findings += describe_time(table, gap)
    if session_end(path) is SessionEnd.UNMARKED:
        findings.append(f"the session has no end mark: {SessionEnd.UNMARKED.value}")
    _drop_duplicates(table)
    counters = [table.columns[name] for name in COUNTERS if name in table.columns]
    starts = episode_starts(table.stamps, counters, gap)
    thresholds = session_thresholds(path)
    return Log(path, table.stamps, table.columns, starts, tuple(findings), thresholds)


def _check_usable(table: Table, header: Sequence[str]) -> None:
    for tally, what in ((table.long, "more"), (table.short, "fewer")):
        if tally.count > table.total / 2 and table.total > 1:
            raise UnreadableLog(
                f"mixed schemas: the header names {len(header)} columns, but {tally.count} of "
                f"{table.total} rows have {what} fields (first on line {tally.first})"
            )
    if not table.stamps.size:
        raise UnreadableLog(f"none of its {table.total} rows is usable (line 2 is the first)")


def _drop_wrong_flags(table: Table) -> list[str]:
    """Silence flags that are neither 0 nor 1; gives what there is to say of it."""
    findings = []
    for name in FLAGS:
        if name in table.columns:
            column = table.columns[name]
            wrong = np.flatnonzero(np.isfinite(column) & (column != 0) & (column != 1))
            if wrong.size:
                findings.append(
                    f"{wrong.size} values of {name} are neither 0 nor 1 (first on line "
                    f"{table.lines[wrong[0]]}): left out"
                )
                column[wrong] = np.nan
    return findings


def _drop_duplicates(table: Table) -> None:
    """Of consecutive rows with one time keep the last: its counters are up to date."""
    table.keep(np.append(np.diff(table.stamps) != 0, True))
