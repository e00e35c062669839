"""Words after -m, to metrics; every column of a log is one. The table of codes stands in tables.txt."""

import pytest

from rover_metrics.analysis import metric as of
from rover_metrics.analysis.metric import METRICS, Kind, choose, is_other, other_metric
from rover_metrics.core.columns import COLUMNS, ROBOTERRAIN_COLUMNS
from rover_metrics.errors import RoverMetricsError
from rover_metrics.extended.metrics import EXTENDED_HEADER

HEADER = [*COLUMNS, "Slip", "Peak Jerk [m/s^3]", "battery [V]", "VORT [m/s]"]


@pytest.mark.parametrize(
    ("column", "label", "kind", "short"),
    [
        ("Peak Jerk [m/s^3]", "Peak Jerk [m/s³]", Kind.LEVEL, "Peak Jerk"),
        ("Jolt [left] [m/s^2]", "Jolt [left] [m/s²]", Kind.LEVEL, "Jolt [left]"),
        ("Collision Events", "Collision Events [1/min]", Kind.COUNTER, "Collision Events"),
        ("my [odd] name", "my [odd] name", Kind.LEVEL, "my [odd] name"),
        ("a\x1b[31m", "a?[31m", Kind.LEVEL, "a?[31m"),
    ],
)
def test_any_other_column_is_a_metric_too(column: str, label: str, kind: Kind, short: str) -> None:
    metric = other_metric(column)
    assert (metric.columns, metric.label, metric.kind, metric.short) == ((column,), label, kind, short)


def test_columns_that_only_grow_are_reported_as_rates() -> None:
    assert tuple(column.name for column in ROBOTERRAIN_COLUMNS if column.cumulative) == of.COUNTERS
    others = [name for name in EXTENDED_HEADER if is_other(name)]
    rates = [name for name in others if other_metric(name).kind is Kind.COUNTER]
    counted = ("Events", "Scans", "Collisions", "Rejected", "Lost")
    assert rates == [name for name in EXTENDED_HEADER[12:] if name.endswith(counted)]
    assert not any(map(is_other, (*COLUMNS, "VORT [m/s]", "")))


@pytest.mark.parametrize(
    ("words", "codes"),
    [
        (["oc", "TSR", "OC"], ["OC", "TSR"]),
        (["Obstacle clearance", "vort [m/s]", "vort"], ["OC", "VORT"]),
        (["peak jerk", "Peak Jerk [m/s^3]", " BATTERY"], ["Peak Jerk [m/s^3]", "battery [V]"]),
        (["slip", "ALL"], ["Slip", *METRICS, "Peak Jerk [m/s^3]", "battery [V]"]),
        (["current velocity"], ["CV"]),  # not that of the other column with this name
    ],
)
def test_a_metric_is_named_by_code_or_column_and_counts_once(words: list[str], codes: list[str]) -> None:
    headers = [["Current Velocity [km/h]", *COLUMNS]] if words == ["current velocity"] else [HEADER]
    assert [metric.code for metric in choose(words, [COLUMNS, *headers])] == codes


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("timestamp", "times and notes are no metrics"),
        ("Roughness RMS", "no log has this column; metrics_node writes it with extended_columns:=true"),
        ("slop", "choose from TC, CS, SM, TSR, .*, all, or a column of the logs, such as Slip$"),
        ("", "or a column of the logs$"),
    ],
)
def test_a_word_that_is_neither_is_told_with_what_there_is(word: str, told: str) -> None:
    with pytest.raises(RoverMetricsError, match=f"^-m {word}: .*{told}"):
        choose([word], [HEADER])
