"""The metrics of a log by the codes of RoboTerrain's metrics_analyzer, and how each is reported.

Every other column of a log is a metric too, under its own name.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType

from rover_metrics.errors import printable
from rover_metrics.extended.metrics import EXTENDED_COLUMNS as _EXTENDED

STAMP = "Timestamp"
ROUGH = "Is Rough Terrain"
COLLISION = "Current Collision Status"
SMOOTHNESS, SMOOTHNESS_SUM = "Current Smoothness", "Smoothness Metric"
CLEARANCE, ACCELERATION = "Obstacle Clearance", "IMU Acceleration Magnitude"
DISTANCE = "Distance Traveled"
NOTES = "Notes"
VORT = "VORT [m/s]"


class Kind(Enum):
    """What a column holds, and so what can be said of it.

    LEVEL is a value of its own in each row. COUNTER only grows, so its rows say little and its rate
    per minute says all. FLAG is 0 or 1 and is reported as the share of rows that are 1, in percent.
    """

    LEVEL = "level"
    COUNTER = "counter"
    FLAG = "flag"


@dataclass(frozen=True)
class Metric:
    """One metric.

    Attributes:
        code: RoboTerrain's short name; of any other column its name in the log.
        title: What is reported, for tables and axes.
        kind: How the column is read.
        thresholds: Names in thresholds.py that bound this very quantity.
        rough_only: Whether only rows with Is Rough Terrain = 1 count.
        extended_column: The column of an extended log that says it better, and is used if it is there.
    """

    code: str
    column: str
    title: str
    unit: str
    kind: Kind = Kind.LEVEL
    thresholds: tuple[str, ...] = ()
    rough_only: bool = False
    extended_column: str = ""

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


_ALL = (
    Metric("TC", "Total Collisions", "Collisions", "scans/min", Kind.COUNTER),
    Metric("CS", COLLISION, "Time in collision", "% of rows", Kind.FLAG),
    Metric("SM", SMOOTHNESS_SUM, "Smoothness sum", "(m/s² + rad/s)/min", Kind.COUNTER),
    Metric(
        "TSR",
        SMOOTHNESS,
        "Smoothness of the route",
        "m/s² + rad/s",
        thresholds=("smoothness_threshold",),
    ),
    Metric(
        "OC",
        CLEARANCE,
        "Obstacle clearance",
        "m",
        thresholds=("collision_threshold", "min_safe_clearance"),
    ),
    Metric("DT", DISTANCE, "Distance traveled", "m/min", Kind.COUNTER),
    Metric("CV", "Current Velocity", "Current velocity", "m/s"),
    Metric(
        "VORT",
        "Current Velocity",
        "Velocity over rough terrain",
        "m/s",
        rough_only=True,
        extended_column=VORT,
    ),
    Metric(
        "IM",
        ACCELERATION,
        "IMU acceleration",
        "m/s²",
        thresholds=("rough_terrain_threshold",),
    ),
    Metric("RT", ROUGH, "Time on rough terrain", "% of rows", Kind.FLAG),
    Metric("VR", "Vertical Roughness", "Vertical roughness", "m/s²"),
)

METRICS: Mapping[str, Metric] = MappingProxyType({metric.code: metric for metric in _ALL})

COUNTERS = tuple(metric.column for metric in _ALL if metric.kind is Kind.COUNTER)
FLAGS = tuple(metric.column for metric in _ALL if metric.kind is Kind.FLAG)
METRIC_COLUMNS = tuple(dict.fromkeys(metric.column for metric in _ALL))

_CUMULATIVE = {column.header for column in _EXTENDED if column.cumulative}


def is_other(column: str) -> bool:
    """Returns whether a column of a log is neither time, nor text, nor read for one of the codes."""
    return column not in {STAMP, NOTES, *METRIC_COLUMNS, *(m.extended_column for m in _ALL)}


def other_metric(column: str) -> Metric:
    """Returns the metric of a column that has no code: of a count its rate, else the values."""
    name = printable(column)
    title, bracket, rest = name.rpartition(" [")
    title, unit = (title, rest[:-1]) if bracket and rest.endswith("]") else (name, "")
    unit = unit.replace("^2", "²").replace("^3", "³")
    if column in _CUMULATIVE:
        return Metric(name, column, title, f"{unit or '1'}/min", Kind.COUNTER)
    return Metric(name, column, title, unit)
