"""Which metrics the words after -m mean: codes, names of columns, or all that the logs have."""

import difflib
from collections.abc import Iterable, Sequence

from rover_metrics.analysis.metric import METRIC_COLUMNS, METRICS, Metric, is_other, other_metric
from rover_metrics.core.columns import COLUMNS
from rover_metrics.errors import RoverMetricsError
from rover_metrics.extended.metrics import EXTENDED_HEADER

ALL = "all"


class UnknownMetric(RoverMetricsError):
    """A word that is neither a code nor a column."""


def choose(words: Iterable[str], headers: Iterable[Sequence[str]]) -> tuple[Metric, ...]:
    """Returns the metrics that are meant, each once.

    Args:
        words: Codes, columns with or without their units, or "all"; capitals or not.
        headers: Column names of each log.

    Raises:
        UnknownMetric: A word is none of these; the message names what is.
    """
    columns = list(dict.fromkeys(name for header in headers for name in header))
    others = (other_metric(column) for column in columns if is_other(column))
    everything, chosen = [*METRICS.values(), *others], dict[str, Metric]()
    for word in words:
        metrics = everything if word.casefold() == ALL else [_one(word.strip(), columns)]
        chosen.update((metric.code, metric) for metric in metrics)
    return tuple(chosen.values())


def _one(word: str, columns: Sequence[str]) -> Metric:
    if word.upper() in METRICS:
        return METRICS[word.upper()]
    for column in (*METRIC_COLUMNS, *columns):
        if word.casefold() in _spellings(column):
            if is_other(column):
                return other_metric(column)
            of_column = (m for m in METRICS.values() if column in (m.column, m.extended_column))
            if (metric := next(of_column, None)) is not None:
                return metric
    raise UnknownMetric(f"-m {word}: {_why_unknown(word, columns)}")


def _spellings(column: str) -> tuple[str, str]:
    """Returns a column's name with its unit and without."""
    return column.casefold(), column.partition(" [")[0].casefold()


def _why_unknown(word: str, columns: Sequence[str]) -> str:
    if word.casefold() in [column.casefold() for column in COLUMNS]:
        return "times and notes are no metrics"
    if any(word.casefold() in _spellings(column) for column in EXTENDED_HEADER):
        return "no log has this column; metrics_node writes it with extended_columns:=true"
    names = {spelling: column for column in columns for spelling in _spellings(column)}
    near = [names[each] for each in difflib.get_close_matches(word.casefold(), names)]
    such = f", such as {', '.join(dict.fromkeys(near))}" if near else ""
    return f"choose from {', '.join(METRICS)}, {ALL}, or a column of the logs{such}"
