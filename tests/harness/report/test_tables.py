"""The report's tables and what it reads back from a log."""

import math
from dataclasses import replace

import pytest

from harness.episode.result import RunResult, TopicCount
from harness.episode.truth_account import TruthAlong
from harness.report.log import Log
from harness.report.tables import (
    Comparison,
    comparisons,
    contact_rows,
    facts,
    key_figures,
    steady_text,
)
from harness.spec.run import Run
from harness.truth.traversal import ContactEvent, Truth
from rover_metrics.core.thresholds import Thresholds

TRUTH = Truth(
    time_ns=10_000_000_000,
    path_length=4.0,
    hazard_contacts=2,
    rock_contacts=5,
    scrapes=7,
    hazard_contact_s=0.25,
    rock_contact_s=1.5,
    scrape_s=0.75,
    mean_slip=0.129,
    largest_tilt=math.radians(30.4),
)


EVENT = ContactEvent(
    "hazard", 1_500_000_000, 1_750_000_000, "chassis", "hazard_3", 41.6, (0.2, 0.1, 0.0)
)


RESULT = RunResult(
    config=Run(),
    mode="direct",
    truth=TRUTH,
    wall_s=4.0,
    topics={"/scan": TopicCount(12_000, 11_990, 10)},
    thresholds=Thresholds(collision_threshold=0.3),
    last_row={"Distance Traveled": 4.1, "Total Collisions": 6},
    along=TruthAlong(events=(EVENT, replace(EVENT, kind="rock"), replace(EVENT, kind="scrape"))),
)


LOG = Log(
    [1.0, 2.0, 3.0],
    {
        "Current Velocity": [0.3, 0.3, 0.6],
        "Obstacle Clearance": [math.nan, math.inf, 1.5],
        "Is Rough Terrain": [0.0, 1.0, 1.0],
    },
)


def test_metrics_stand_beside_the_truth_with_their_difference() -> None:
    assert comparisons(RESULT, LOG) == [
        Comparison("Distance", "4.10 m", "4.00 m", "+2.5 %"),
        Comparison("Mean speed", "0.40 m/s", "0.40 m/s", "0.0 %"),
        Comparison("Collisions", "6 scans below 0.3 m", "2 contacts with hazards, 0.25 s"),
        Comparison("Smallest clearance logged", "1.50 m"),
        Comparison("Rough terrain", "2 of 3 rows"),
        Comparison("Wheel slip, mean of moving wheels", truth="0.13"),
        Comparison("On rocks", truth="5 contacts, 1.50 s"),
        Comparison("Body scraping the ground", truth="7 times, 0.75 s"),
        Comparison("Largest tilt", truth="30°"),
    ]


def test_a_metric_below_the_truth_has_a_minus_and_no_truth_no_difference() -> None:
    short = replace(RESULT, last_row={"Distance Traveled": 3.5, "Total Collisions": 0})
    assert comparisons(short, LOG)[0].difference == "\N{MINUS SIGN}12.5 %"
    stood = replace(RESULT, truth=replace(TRUTH, path_length=0.0, tipped_over=True))
    told = comparisons(stood, LOG)
    assert told[0].difference == "\N{EN DASH}"
    assert told[-1].truth == "30°, tipped over"


def test_without_a_log_there_is_only_the_truth() -> None:
    told = comparisons(replace(RESULT, last_row=None), Log())
    assert [one.metric for one in told] == ["\N{EN DASH}"] * 9
    assert told[0].truth == "4.00 m"


def test_contacts_are_told_in_words() -> None:
    assert contact_rows(RESULT) == [
        (f"chassis {doing} hazard_3", "1.50 s", "0.25 s", "42 N") for doing in ("hits", "on", "scrapes")
    ]


def test_key_figures_are_those_of_the_run() -> None:
    assert [value for _, value in key_figures(RESULT)] == [
        *("10.0 s", "4.0 m", "2", "30°", "0.13", "10 of 12,000", "2.5\N{MULTIPLICATION SIGN} real time")
    ]


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
