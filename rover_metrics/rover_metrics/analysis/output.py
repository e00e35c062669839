"""What is written to the output folder. File names come from metrics, never from the names of logs."""

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from rover_metrics.analysis.outcome import Result
from rover_metrics.analysis.page import page
from rover_metrics.analysis.plots.aggregate import draw_aggregate
from rover_metrics.analysis.plots.comparison import draw_comparison
from rover_metrics.analysis.plots.correlation import draw_correlation
from rover_metrics.analysis.plots.style import STYLE, save
from rover_metrics.analysis.plots.time_series import draw_time_series
from rover_metrics.analysis.statistics.series import metric_series
from rover_metrics.analysis.study import Study
from rover_metrics.analysis.tables import sheets
from rover_metrics.core.columns import Field
from rover_metrics.errors import RoverMetricsError, counted, reason_of
from rover_metrics.log.files import write_whole
from rover_metrics.sheet.render import csv_text, latex
from rover_metrics.sheet.sheet import Sheet

_LONGEST_NAME = 60  # letters of a file name
OUTLIER = ("Log", "Path", "Timestamp", "Metric", "Value", "Unit")  # columns of outliers.csv
_PARTS = dict.fromkeys(("n", "means"), ("first", "second"))  # names of the parts of values that are two
_PARTS |= dict.fromkeys(("interval", "bootstrap_interval"), ("low", "high"))


class OutputError(RoverMetricsError):
    """The output folder cannot be created or written."""

    def __init__(self, folder: Path, error: Exception) -> None:
        super().__init__(f"cannot write to {folder}: {reason_of(error)}; choose another folder with -o")


def prepare_folder(folder: Path) -> None:
    """Creates the output folder, or raises OutputError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise OutputError(folder, error) from error


def save_all(
    study: Study, result: Result, folder: Path, *, as_csv: bool, as_latex: bool, outliers: bool
) -> list[Path]:
    """Writes what is asked for into a folder that exists, and returns the files.

    Args:
        study: Its plots are drawn, two files a figure.
        result: Its numbers.
        folder: Where to.
        as_csv: Whether to write all numbers, see `write_csv`.
        as_latex: Whether to write the tables, one per file.
        outliers: Whether to write every outlier of every log.
    """
    try:
        with mpl.rc_context(STYLE):
            drawn = (save(figure, folder, name) for name, figure in _figures(study, result) if figure)
            files = [path for paths in drawn for path in paths]
        files += write_csv(result, folder) if as_csv else []
        for sheet in sheets(result) if as_latex else ():
            files.append(folder / f"{sheet.file}.tex")
            write_whole(files[-1], latex(sheet))
        if outliers:
            files.append(folder / "outliers.csv")
            write_whole(files[-1], csv_text(list(_outliers(study)), OUTLIER))
    except OSError as error:
        raise OutputError(folder, error) from error
    return files


def page_of(study: Study, result: Result, more: Iterable[Sheet] = ()) -> str:
    """Returns a page of the plots and the tables.

    Args:
        study: What was asked.
        result: What came out.
        more: Further tables, behind the others.
    """
    drawn = ((name.replace("_", " "), figure, "") for name, figure in _figures(study, result) if figure)
    logs = counted(len(result.logs), "log")
    return page("Logs of rovers", f"{logs}: {', '.join(result.groups)}", drawn, [*sheets(result), *more])


def _figures(study: Study, result: Result) -> Iterator[tuple[str, Figure | None]]:
    """Draws one figure at a time, so that no more than one is in memory."""
    options = study.options
    if "time_series" in options.plots:
        names = _file_names([metric.code for metric in options.metrics])
        for metric, name in zip(options.metrics, names, strict=True):
            yield f"time_series_{name}", draw_time_series(study, metric)
    if "correlation" in options.plots:
        alpha = 1 - options.confidence
        yield "correlation", draw_correlation(result.correlations, options.metrics, alpha)
    if "aggregate" in options.plots:
        yield "aggregate", draw_aggregate(study)
    if "comparison" in options.plots:
        yield "comparison", draw_comparison(study, result)


def _file_names(codes: Sequence[str]) -> list[str]:
    """Returns a part of a file name for each code, which may be any column's name; all differ."""
    names: list[str] = []
    for code in codes:
        plain = re.sub(r"[^A-Za-z0-9]+", "_", code).strip("_")[:_LONGEST_NAME] or "column"
        numbered = itertools.chain([plain], (f"{plain}_{number}" for number in itertools.count(2)))
        taken = {name.casefold() for name in names}  # some file systems know no capitals
        names.append(next(name for name in numbered if name.casefold() not in taken))
    return names


def write_csv(result: Result, folder: Path) -> list[Path]:
    """Writes logs.csv and, if they have rows, those of the other tables; returns the files."""
    across = (
        {"group": group, **_record(result, {"code": code, **asdict(summary)})}
        for group, summaries in result.across.items()
        for code, summary in summaries.items()
    )
    tables = {
        "logs": list(_logs(result)),
        "across": list(across) if len(result.logs) > 1 else [],
        "comparison": [_record(result, asdict(item)) for item in result.comparisons],
        "correlation": [asdict(item) for item in result.correlations],
    }
    files = {folder / f"{name}.csv": rows for name, rows in tables.items() if rows}
    for path, rows in files.items():
        write_whole(path, csv_text(rows))
    return list(files)


def _logs(result: Result) -> Iterator[dict[str, Any]]:
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


def _record(result: Result, values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the values of a metric by column: pairs as two, what it reports beside its code."""
    record: dict[str, Any] = {}
    for name, value in values.items():
        if name in _PARTS and not isinstance(value, int):
            names = (f"{name}_{part}" for part in _PARTS[name])
            record |= zip(names, value or (None, None), strict=True)
            continue
        record[name] = value
        if name == "code":
            record["title"] = result.titles[value]
    return record


def _outliers(study: Study) -> Iterator[dict[str, Field]]:
    for log in study.logs:
        for metric in study.options.metrics:
            if log.has(metric):
                series = metric_series(log, metric)
                for row in np.flatnonzero(study.outliers(log, metric)):
                    stamp, value = float(log.stamps[row]), round(float(series.values[row]), 6)
                    where = (log.label, str(log.path), stamp)
                    yield dict(zip(OUTLIER, (*where, metric.code, value, metric.unit), strict=True))
