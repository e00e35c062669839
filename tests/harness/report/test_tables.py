"""The report's tables and what it reads back from a log."""

import math
from dataclasses import replace

import pytest

from harness.report.log import Log
from harness.report.tables import comparisons, facts, steady_text
from tests.harness.report.made import RESULT, stretches


def test_a_metric_below_the_truth_has_a_minus_and_no_truth_no_difference() -> None:
    short = replace(RESULT, last_row={"Distance Traveled": 7.0, "Total Collisions": 0})
    assert comparisons(short, Log(), []).rows[0][-1] == "\N{MINUS SIGN}12.5\N{NO-BREAK SPACE}%"
    stood = replace(RESULT, truth=replace(RESULT.truth, path_length=0.0, tipped_over=True))
    rows = comparisons(stood, Log(), []).rows
    assert rows[0][-1] == "\N{EN DASH}"
    assert rows[-1][2] == "30°, tipped over"


def test_without_a_log_and_people_there_is_only_the_truth() -> None:
    rows = comparisons(replace(RESULT, last_row=None), Log(), stretches({})).rows
    assert [metric for _, metric, _, _ in rows] == ["\N{EN DASH}"] * 9
    assert rows[0][2] == "8.00 m"


def test_nested_values_become_flat_pairs_with_their_units() -> None:
    values = {"seed": 4, "duration": 2.5, "noise": False, "a": {"b": True, "timestep": 0.0025}}
    assert facts({**values, "empty": [], "none": None, "sizes": (1.5, 2)}) == [
        *(("seed", "4"), ("duration", "2.5 s"), ("noise", "no")),
        *(("a.b", "yes"), ("a.timestep", "0.0025 s")),
        *(("empty", "\N{EN DASH}"), ("none", "\N{EN DASH}"), ("sizes", "1.5, 2")),
    ]


@pytest.mark.parametrize(
    ("name", "values", "text"),
    [
        ("VORT [m/s]", [math.nan, math.nan], "empty"),
        ("VORT [m/s]", [math.nan, 0.25, 0.25], "0.25 m/s in 2 of 3 rows"),
        ("Vertical Roughness", [9.8, 9.8], "9.8 m/s²"),
        ("Scan Lost", [0.0, 0.0], "0"),
        ("Obstacle Clearance", [math.inf], "inf m"),
    ],
)
def test_a_column_that_stays_the_same_is_told_by_its_value(
    name: str, values: list[float], text: str
) -> None:
    assert steady_text(name, values) == text
