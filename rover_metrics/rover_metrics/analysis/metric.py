"""The metrics of a log by the codes of RoboTerrain's metrics_analyzer, and which one a word means.

Every other column of a log is a metric too, under its own name.
"""

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType

from rover_metrics.core.columns import COLUMNS
from rover_metrics.errors import RoverMetricsError, printable
from rover_metrics.extended.metrics import ALL_COLUMNS, EXTENDED_HEADER
from rover_metrics.sheet.sheet import spelled

ALL = "all"  # the word for every metric

STAMP = "Timestamp"
ROUGH, COLLISION = "Is Rough Terrain", "Current Collision Status"
SMOOTHNESS, SMOOTHNESS_SUM = "Current Smoothness", "Smoothness Metric"
CLEARANCE, ACCELERATION = "Obstacle Clearance", "IMU Acceleration Magnitude"
DISTANCE = "Distance Traveled"
VELOCITY, VORT = "Current Velocity", "VORT [m/s]"
NOTES = "Notes"


class Kind(Enum):
    """What a column holds, and so what can be said of it."""

    LEVEL = "level"  # a value of its own in each row
    COUNTER = "counter"  # only grows, so its rate per minute is reported
    FLAG = "flag"  # 0 or 1, reported as the share of rows that are 1, in percent


@dataclass(frozen=True)
class Metric:
    """One metric."""

    code: str  # RoboTerrain's short name; of any other column its name in the log
    column: str
    title: str  # what is reported, for tables and axes
    unit: str
    kind: Kind = Kind.LEVEL  # how the column is read
    thresholds: tuple[str, ...] = ()  # names in core/thresholds.py that bound this very quantity
    rough_only: bool = False  # whether only rows with Is Rough Terrain = 1 count
    extended_column: str = ""  # says it better, and is used where a log has it

    @property
    def columns(self) -> tuple[str, ...]:
        """Returns the columns that a log must have for this metric."""
        return (self.column, ROUGH) if self.rough_only else (self.column,)

    @property
    def short(self) -> str:
        """What it is called where room is scarce: its code, or the column's name without a unit."""
        return self.title if is_other(self.column) else self.code

    @property
    def label(self) -> str:
        """What is reported, with its unit."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title


LEVEL, COUNTER, FLAG = Kind
_ALL = (
    Metric("TC", "Total Collisions", "Collisions", "scans/min", COUNTER),
    Metric("CS", COLLISION, "Time in collision", "% of rows", FLAG),
    Metric("SM", SMOOTHNESS_SUM, "Smoothness sum", "(m/s² + rad/s)/min", COUNTER),
    Metric(
        "TSR", SMOOTHNESS, "Smoothness of the route", "m/s² + rad/s", LEVEL, ("smoothness_threshold",)
    ),
    Metric(
        "OC", CLEARANCE, "Obstacle clearance", "m", LEVEL, ("collision_threshold", "min_safe_clearance")
    ),
    Metric("DT", DISTANCE, "Distance traveled", "m/min", COUNTER),
    Metric("CV", VELOCITY, "Current velocity", "m/s"),
    Metric(
        "VORT", VELOCITY, "Velocity over rough terrain", "m/s", rough_only=True, extended_column=VORT
    ),
    Metric("IM", ACCELERATION, "IMU acceleration", "m/s²", LEVEL, ("rough_terrain_threshold",)),
    Metric("RT", ROUGH, "Time on rough terrain", "% of rows", FLAG),
    Metric("VR", "Vertical Roughness", "Vertical roughness", "m/s²"),
)

METRICS: Mapping[str, Metric] = MappingProxyType({metric.code: metric for metric in _ALL})
COUNTERS = tuple(metric.column for metric in _ALL if metric.kind is COUNTER)
FLAGS = tuple(metric.column for metric in _ALL if metric.kind is FLAG)
METRIC_COLUMNS = tuple(dict.fromkeys(metric.column for metric in _ALL))
_CUMULATIVE = {column.header for column in ALL_COLUMNS if column.cumulative}


def is_other(column: str) -> bool:
    """Returns whether a column of a log is neither time, nor text, nor read for one of the codes."""
    return column not in {STAMP, NOTES, *METRIC_COLUMNS, *(m.extended_column for m in _ALL)}


def other_metric(column: str) -> Metric:
    """Returns the metric of a column that has no code: of a count its rate, else the values."""
    name = printable(column)
    title, bracket, rest = name.rpartition(" [")
    title, unit = (title, rest[:-1]) if bracket and rest.endswith("]") else (name, "")
    if column in _CUMULATIVE:
        return Metric(name, column, title, f"{spelled(unit) or '1'}/min", COUNTER)
    return Metric(name, column, title, spelled(unit))


def choose(words: Iterable[str], headers: Iterable[Sequence[str]]) -> tuple[Metric, ...]:
    """Returns the metrics that words mean, each once.

    Words are codes, columns of the headers with or without their units, or "all"; capitals or not.

    Raises:
        RoverMetricsError: A word is none of these; the message names what is.
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
            for metric in METRICS.values():
                if column in (metric.column, metric.extended_column):
                    return metric
    raise RoverMetricsError(f"-m {word}: {_why_unknown(word, columns)}")


def _spellings(column: str) -> tuple[str, str]:
    """A column's name with its unit and without."""
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
