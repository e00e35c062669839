"""What is written to the output folder. File names come from metrics, never from the names of logs."""

import contextlib
import csv
from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from rover_metrics.analysis.plots.aggregate import draw_aggregate
from rover_metrics.analysis.plots.comparison import draw_comparison
from rover_metrics.analysis.plots.correlation import draw_correlation
from rover_metrics.analysis.plots.style import STYLE, save
from rover_metrics.analysis.plots.time_series import draw_time_series
from rover_metrics.analysis.result import Result
from rover_metrics.analysis.statistics.series import metric_series
from rover_metrics.analysis.study import Study
from rover_metrics.core.row import Field
from rover_metrics.errors import RoverMetricsError
from rover_metrics.log.csv_log import harmless


class OutputError(RoverMetricsError):
    """The output folder cannot be created or written."""


@contextlib.contextmanager
def _writing(folder: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise OutputError(
            f"cannot write to {folder}: {reason}; choose another folder with -o"
        ) from error


def prepare_folder(folder: Path) -> None:
    """Creates the output folder, or raises OutputError."""
    with _writing(folder):
        folder.mkdir(parents=True, exist_ok=True)


def save_plots(study: Study, result: Result, folder: Path) -> list[Path]:
    """Draws and writes the plots asked for.

    Args:
        study: The logs.
        result: What was found out about them.
        folder: Must exist.

    Returns:
        The files, two a figure.

    Raises:
        OutputError: A file cannot be written.
    """
    files: list[Path] = []
    with mpl.rc_context(STYLE):
        for name, figure in _figures(study, result):
            if figure is not None:
                with _writing(folder):
                    files += save(figure, folder, name)
    return files


def _figures(study: Study, result: Result) -> Iterator[tuple[str, Figure | None]]:
    """Draws one figure at a time, so that no more than one is in memory."""
    options = study.options
    if "time_series" in options.plots:
        for metric in options.metrics:
            yield f"time_series_{metric.code}", draw_time_series(study, metric)
    if "correlation" in options.plots:
        alpha = 1 - options.confidence
        yield "correlation", draw_correlation(result.correlations, options.metrics, alpha)
    if "aggregate" in options.plots:
        yield "aggregate", draw_aggregate(study)
    if "comparison" in options.plots:
        yield "comparison", draw_comparison(study, result)


def save_outliers(study: Study, folder: Path) -> Path:
    """Writes every outlier of every log to outliers.csv: log, path, time, metric, value, unit.

    Raises:
        OutputError: The file cannot be written.
    """
    path = folder / "outliers.csv"
    with _writing(folder), path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(("Log", "Path", "Timestamp", "Metric", "Value", "Unit"))
        writer.writerows(map(harmless, row) for row in _outlier_rows(study))
    return path


def _outlier_rows(study: Study) -> Iterator[tuple[Field, ...]]:
    for member in study.members:
        for metric in study.options.metrics:
            if member.log.has(metric):
                series = metric_series(member.log, metric)
                for row in np.flatnonzero(study.outliers(member.log, metric)):
                    stamp, value = float(member.log.stamps[row]), round(float(series.values[row]), 6)
                    yield member.label, str(member.log.path), stamp, metric.code, value, metric.unit
