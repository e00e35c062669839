"""Words after -m, to metrics."""

import pytest

from rover_metrics.analysis.metric import METRICS, UnknownMetric, choose
from rover_metrics.core.columns import COLUMNS

HEADER = [*COLUMNS, "Slip", "Peak Jerk [m/s^3]", "battery [V]", "VORT [m/s]"]


@pytest.mark.parametrize(
    ("words", "codes"),
    [
        (["oc", "TSR", "OC"], ["OC", "TSR"]),
        (["Obstacle clearance", "vort [m/s]", "vort"], ["OC", "VORT"]),
        (["Current Velocity"], ["CV"]),
        (["peak jerk", "Peak Jerk [m/s^3]", " BATTERY"], ["Peak Jerk [m/s^3]", "battery [V]"]),
        (["ALL"], [*METRICS, "Slip", "Peak Jerk [m/s^3]", "battery [V]"]),
        (["slip", "all"], ["Slip", *METRICS, "Peak Jerk [m/s^3]", "battery [V]"]),
    ],
)
def test_a_metric_is_named_by_code_or_column_and_counts_once(words: list[str], codes: list[str]) -> None:
    assert [metric.code for metric in choose(words, [COLUMNS, HEADER])] == codes


def test_what_the_codes_are_read_from_comes_before_another_column_of_that_name() -> None:
    (metric,) = choose(["current velocity"], [["Current Velocity [km/h]", *COLUMNS]])
    assert metric.code == "CV"


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("Notes", "times and notes are no metrics"),
        ("timestamp", "times and notes are no metrics"),
        ("Roughness RMS", "no log has this column; metrics_node writes it with extended_columns:=true"),
        ("slop", "choose from TC, CS, SM, TSR, .*, all, or a column of the logs, such as Slip$"),
        ("xyzzy", "or a column of the logs$"),
        ("", "or a column of the logs$"),
    ],
)
def test_a_word_that_is_neither_is_told_with_what_there_is(word: str, told: str) -> None:
    with pytest.raises(UnknownMetric, match=f"^-m {word}: .*{told}"):
        choose([word], [HEADER])
