"""A log read back, the events in it and in the truth, and the tables made of them."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from harness.page.run import encounters as module
from harness.page.run.encounters import Encounter, encounters
from harness.page.run.log import Log, caption, collisions, contacts, describe, read_log
from harness.page.run.recorder import Approach, Stretch
from harness.page.run.tables import comparisons, facts, steady_text
from rover_metrics.extended.truth_columns import truth_columns
from tests.harness.page.run.made import RESULT, stretches


def test_a_log_is_read_back_as_numbers_and_counted_notes(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    rows = ["Timestamp,A,B [m],Notes", "1,2.5,inf,calm", "2,x,4,calm", '3,1,,"rough, fast"', "4,7"]
    path.write_text("\r\n".join(rows) + "\r\n")
    log = read_log(path)
    assert log.time_s == [1.0, 2.0, 3.0, 4.0]
    assert log.columns == {
        "A": pytest.approx([2.5, math.nan, 1.0, 7.0], nan_ok=True),
        "B [m]": pytest.approx([math.inf, 4.0, math.nan, math.nan], nan_ok=True),
    }
    assert log.notes == [("calm", 2), ("rough, fast", 1), ("", 1)]
    assert read_log(None) == read_log(tmp_path / "absent.csv") == Log()


def test_columns_of_any_wheel_are_described_as_the_data_dictionary_does() -> None:
    columns = truth_columns(("front_left", "middle_right_2"), soil=True)
    assert [describe(column.header) for column in columns] == list(columns)
    told = caption("True Slip Angle Middle Right 2 [rad]")
    assert "Between the plane of the middle right 2 wheel" in told
    assert describe("Other [m]").unit == "m"


@pytest.mark.parametrize(
    ("nearest", "times", "counts", "events"),
    [
        ((0.4, 0.15, 0.3, None), [1.0, 3.0, 4.0], [0.0, 2.0, 2.0], [(1.0, 3.0, 2.0)]),
        ((None,) * 3, [1.2, 1.4, 2.9], [0.0, 1.0, 1.0], [(1.2, 1.4, 2.0)]),  # the stretch around it
        ((0.1, 0.2, 0.1), [1.0, 2.0], [0.0, 1.0], [(1.0, 2.0, 2.0)]),  # not one that has ended
        ((None,) * 3, [1.0, 1.6, 2.5], [1.0, 1.0, 2.0], [(0.0, 1.0, 1.0), (1.6, 2.5, 2.0)]),
    ],
)
def test_logged_collisions_are_placed_where_a_scan_was_nearest(
    nearest: Sequence[float | None], times: list[float], counts: list[float], events: object
) -> None:
    track = stretches(*({} if near is None else {"nearest_range": near} for near in nearest))
    found = collisions(Log(times, {"Total Collisions": counts}), track)
    assert [(event.start_s, event.end_s, event.position[0]) for event in found] == events


def test_contacts_half_a_second_apart_are_one_event_and_farther_ones_two() -> None:
    track = [
        Stretch(time, (time, 0.0, 0.0), 0.0, contact_s=touched)
        for time, touched in ((0.5, 0.1), (1.0, 0.0), (1.5, 0.1), (2.1, 0.0), (2.5, 0.1))
    ]
    found = contacts(track)
    assert [(event.start_s, event.end_s) for event in found] == [(0.0, 1.5), (2.1, 2.5)]
    assert found[0].position == (0.5, 0.0, 0.0)
    assert collisions(Log(), track) == [], "there is no counter"


def test_metrics_stand_beside_the_truth_as_far_as_there_are_any() -> None:
    short = replace(RESULT, last_row={"Distance Traveled": 7.0, "Total Collisions": 0})
    assert comparisons(short, Log(), []).rows[0][-1] == "\N{MINUS SIGN}12.5\N{NO-BREAK SPACE}%"
    stood = replace(RESULT, truth=replace(RESULT.truth, path_length=0.0, tipped_over=True))
    rows = comparisons(replace(stood, last_row=None), Log(), stretches({})).rows
    assert [metric for _, metric, _, _ in rows] == ["\N{EN DASH}"] * 9
    assert (rows[0][2], rows[0][-1], rows[-1][2]) == ("0.00 m", "\N{EN DASH}", "30°, tipped over")


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


def at(time_s: float, *distances: float) -> dict[str, tuple[Approach, ...]]:
    return {"approaches": tuple(Approach(d, time_s, (time_s, 0.0), (time_s, d)) for d in distances)}


def test_each_time_that_somebody_was_near_has_its_nearest_moment() -> None:
    far = [3.4, 3.6, 3.0, 2.0, 2.5, 9.0, 3.5, 3.6]
    track = stretches(*(at(1.0 + i, d, 20.0 - i) for i, d in enumerate(far)))
    assert [(e.person, e.nearest.distance, e.nearest.time_s, e.near_s) for e in encounters(track)] == [
        (0, 3.4, 1.0, 1.0),
        (0, 2.0, 4.0, 3.0),
        (0, 3.5, 7.0, 1.0),
        (1, 13.0, 8.0, 0.0),  # never near: the nearest of the run
    ]
    assert encounters(stretches({}, {})) == []


def test_of_many_the_nearest_are_kept_and_one_of_each_person(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_ENCOUNTERS", 3)
    far = [3.0, 9.0, 1.0, 9.0, 2.0, 9.0, 2.5]
    track = stretches(*(at(1.0 + i, d, 30.0) for i, d in enumerate(far)))
    kept: list[Encounter] = encounters(track)
    assert [(e.person, e.nearest.distance) for e in kept] == [(1, 30.0), (0, 1.0)]
    monkeypatch.setattr(module, "MOST_ENCOUNTERS", 4)
    assert [e.nearest.distance for e in encounters(track)] == [30.0, 1.0, 2.0]
