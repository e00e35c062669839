"""A log read back, what its columns mean, and the events in it and in the truth."""

import math
from pathlib import Path

import pytest

from harness.report.log import Log, caption, collisions, contacts, describe, read_log
from harness.report.recorder import Stretch
from tests.harness.report.made import stretches


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


def test_a_column_that_nobody_knows_has_the_unit_in_its_name() -> None:
    assert (describe("Heat [K]").unit, describe("Heat").unit) == ("K", "")
    assert describe("True Slip Middle Left").meaning == "Slip ratio of the middle left wheel, -1 to 1."
    assert caption("Heat [K]") == "The data dictionary does not know this column."


def test_logged_collisions_are_placed_where_a_scan_was_nearest() -> None:
    track = stretches({"nearest_range": 0.4}, {"nearest_range": 0.15}, {"nearest_range": 0.3}, {})
    log = Log([1.0, 3.0, 4.0], {"Total Collisions": [0.0, 2.0, 2.0]})
    (event,) = collisions(log, track)
    assert (event.start_s, event.end_s) == (1.0, 3.0)
    assert event.position == (2.0, 0.0, 0.0)


def test_a_collision_between_two_stretches_is_placed_in_the_one_around_it() -> None:
    track = stretches({}, {}, {})
    (event,) = collisions(Log([1.2, 1.4, 2.9], {"Total Collisions": [0.0, 1.0, 1.0]}), track)
    assert (event.start_s, event.end_s, event.position) == (1.2, 1.4, (2.0, 0.0, 0.0))
    before = stretches({"nearest_range": 0.1}, {"nearest_range": 0.2}, {"nearest_range": 0.1})
    (event,) = collisions(Log([1.0, 2.0], {"Total Collisions": [0.0, 1.0]}), before)
    assert event.position == (2.0, 0.0, 0.0), "a stretch that ends with the row before is not in it"
    rising = Log([1.0, 1.6, 2.5], {"Total Collisions": [1.0, 1.0, 2.0]})
    assert [(e.start_s, e.end_s) for e in collisions(rising, track)] == [(0.0, 1.0), (1.6, 2.5)]


def test_contacts_half_a_second_apart_are_one_event_and_farther_ones_two() -> None:
    track = [
        Stretch(time, (time, 0.0, 0.0), 0.0, contact_s=touched)
        for time, touched in ((0.5, 0.1), (1.0, 0.0), (1.5, 0.1), (2.1, 0.0), (2.5, 0.1))
    ]
    found = contacts(track)
    assert [(event.start_s, event.end_s) for event in found] == [(0.0, 1.5), (2.1, 2.5)]
    assert found[0].position == (0.5, 0.0, 0.0)
    assert collisions(Log(), track) == [], "there is no counter"
