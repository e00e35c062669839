"""Every number of a result as CSV: one file a kind of table, one row a metric of a log or group."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rover_metrics.analysis.result import Result
from rover_metrics.sheet.render import csv_text

_PARTS = {  # of values that are two
    "n": ("first", "second"),
    "means": ("first", "second"),
    "interval": ("low", "high"),
    "bootstrap_interval": ("low", "high"),
}

Record = dict[str, Any]


def write_csv(result: Result, folder: Path) -> list[Path]:
    """Writes logs.csv and, where there is something to say, across.csv, comparison.csv, correlation.csv.

    Returns the files; None is an empty cell.
    """
    tables = {
        "logs": list(_logs(result)),
        "across": list(_across(result)) if len(result.logs) > 1 else [],
        "comparison": [_record(result, asdict(item)) for item in result.comparisons],
        "correlation": [asdict(item) for item in result.correlations],
    }
    files = {folder / f"{name}.csv": rows for name, rows in tables.items() if rows}
    for path, rows in files.items():
        path.write_text(csv_text(rows), encoding="utf-8", newline="")
    return list(files)


def _logs(result: Result) -> Iterator[Record]:
    for log in result.logs:
        for code, summary in log.metrics.items():
            yield {
                "log": log.label,
                "path": log.path,
                "group": log.group,
                **_record(result, {"code": code, **asdict(summary)}),
                "outliers": log.outliers[code],
                "per_metre": log.per_metre.get(code),
            }


def _across(result: Result) -> Iterator[Record]:
    for group, summaries in result.across.items():
        for code, summary in summaries.items():
            yield {"group": group, **_record(result, {"code": code, **asdict(summary)})}


def _record(result: Result, values: Mapping[str, Any]) -> Record:
    """Returns the values of a metric by column: pairs as two, what it reports beside its code."""
    record: Record = {}
    for name, value in values.items():
        if name not in _PARTS or isinstance(value, int):
            record[name] = value
        else:
            first, second = (f"{name}_{part}" for part in _PARTS[name])
            record[first], record[second] = value or (None, None)
        if name == "code":
            record["title"] = result.titles[value]
    return record
