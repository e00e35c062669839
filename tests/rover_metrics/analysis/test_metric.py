"""Words after -m, to metrics; every column of a log is one. The table of codes stands in tables.txt."""

import pytest

from rover_metrics.analysis import metric as of
from rover_metrics.analysis.metric import METRICS, Kind, choose, other_metric
from rover_metrics.core.columns import COLUMNS

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
    with pytest.raises(of.UnknownMetric, match=f"^-m {word}: .*{told}"):
        choose([word], [HEADER])
