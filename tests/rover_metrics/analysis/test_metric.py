"""The table of metrics, written out: its codes are words of the command line."""

from dataclasses import astuple

import pytest

from rover_metrics.analysis.metric import COUNTERS, METRICS, Kind, Metric, is_other, other_metric
from rover_metrics.core.columns import COLUMNS, ROBOTERRAIN_COLUMNS
from rover_metrics.extended.metrics import EXTENDED_HEADER


def test_a_metric_is_read_from_columns_that_every_log_has() -> None:
    for metric in METRICS.values():
        assert set(metric.columns) <= set(COLUMNS)
    assert METRICS["CV"].columns == ("Current Velocity",)
    assert METRICS["VORT"].columns == ("Current Velocity", "Is Rough Terrain")
    plain = Metric("X", "Notes", "x", "m")
    assert astuple(plain)[4:] == (Kind.LEVEL, (), False, "")


@pytest.mark.parametrize(
    ("column", "label", "kind", "short"),
    [
        ("Peak Jerk [m/s^3]", "Peak Jerk [m/s³]", Kind.LEVEL, "Peak Jerk"),
        ("Slip", "Slip", Kind.LEVEL, "Slip"),
        ("Jolt [left] [m/s^2]", "Jolt [left] [m/s²]", Kind.LEVEL, "Jolt [left]"),
        ("Collision Events", "Collision Events [1/min]", Kind.COUNTER, "Collision Events"),
        ("my [odd] name", "my [odd] name", Kind.LEVEL, "my [odd] name"),
        ("a\x1b[31m", "a?[31m", Kind.LEVEL, "a?[31m"),
    ],
)
def test_any_other_column_is_a_metric_too(column: str, label: str, kind: Kind, short: str) -> None:
    metric = other_metric(column)
    assert (metric.columns, metric.label, metric.kind, metric.short) == ((column,), label, kind, short)
    assert METRICS["OC"].short == "OC"


def test_columns_that_only_grow_are_reported_as_rates() -> None:
    assert tuple(column.name for column in ROBOTERRAIN_COLUMNS if column.cumulative) == COUNTERS
    rates = [
        name for name in EXTENDED_HEADER if is_other(name) and other_metric(name).kind is Kind.COUNTER
    ]
    counted = ("Events", "Scans", "Collisions", "Rejected", "Lost")
    assert rates == [name for name in EXTENDED_HEADER[12:] if name.endswith(counted)]
    assert not any(map(is_other, (*COLUMNS, "VORT [m/s]", "")))
