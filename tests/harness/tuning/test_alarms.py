"""Alarms against contacts."""

from collections.abc import Callable

import numpy as np
import pytest

from harness.tuning.alarms import (
    EVENT_MEASURES,
    SCAN_MEASURES,
    alarms,
    event_counts,
    lead_times,
    nearest_or_near_return,
    nearest_range,
    scan_counts,
)
from harness.tuning.record import EpisodeRecord

MakeRecord = Callable[..., EpisodeRecord]

FAR, NEAR = 3.0, 0.18


def test_alarms_closer_than_half_a_second_are_one(make_record: MakeRecord) -> None:
    record = make_record([NEAR] * 3 + [FAR] * 9 + [NEAR] * 2 + [FAR] * 12 + [NEAR])

    found = alarms(record, nearest_range(record), 0.2)

    assert found == pytest.approx(np.array([[0.05, 0.7], [1.35, 1.35]]))


def test_the_threshold_is_strict_as_in_the_metrics(make_record: MakeRecord) -> None:
    record = make_record([0.25] * 3)

    assert len(alarms(record, nearest_range(record), 0.25)) == 0


@pytest.mark.parametrize(
    ("alarm_s", "is_right"),
    [
        (1.0, False),  # a second before the contact
        (1.6, True),  # 0.4 s before: what is touched is then too near to be seen
        (2.1, True),  # during
        (2.5, False),  # after
    ],
)
def test_an_alarm_is_right_shortly_before_or_during_a_contact(
    make_record: MakeRecord, alarm_s: float, is_right: bool
) -> None:
    ranges = np.full(80, FAR)
    ranges[round(alarm_s * 20) - 1] = NEAR
    record = make_record(ranges, contacts=[(2.0, 2.2)])

    contacts, found, raised, right, km = event_counts(nearest_range, [record], np.array([0.2]))[0, 0]

    assert (contacts, raised) == (1, 1)
    assert found == right == is_right
    assert km == pytest.approx(0.004)


def test_a_long_alarm_is_one_and_finds_all_contacts_in_it(make_record: MakeRecord) -> None:
    record = make_record([NEAR] * 80, contacts=[(1.0, 1.2), (3.0, 3.1)])

    sums = event_counts(nearest_range, [record], np.array([0.2]))[0].sum(axis=0)

    assert {name: float(measure(sums)) for name, measure in EVENT_MEASURES.items()} == pytest.approx(
        {"F1": 1.0, "precision": 1.0, "recall": 1.0, "false alarms per km": 0.0}
    )


def test_f1_is_zero_if_nothing_is_found_and_undefined_without_contacts(
    make_record: MakeRecord,
) -> None:
    missed = make_record([FAR] * 20, contacts=[(0.5, 0.6)])
    none = make_record([FAR] * 20)

    f1 = [
        float(EVENT_MEASURES["F1"](event_counts(nearest_range, [r], np.array([0.2]))[0, 0]))
        for r in (missed, none)
    ]

    assert f1[0] == 0.0
    assert np.isnan(f1[1])


def test_scans_are_counted_one_by_one(make_record: MakeRecord) -> None:
    record = make_record([FAR, NEAR, NEAR, FAR], contacts=[(0.05, 0.1)])  # scans 2 and 3 of 4

    sums = scan_counts(nearest_range, [record], np.array([0.2, 5.0])).sum(axis=1)

    assert sums.tolist() == [[2.0, 0.0, 0.0, 2.0], [2.0, 2.0, 0.0, 0.0]]
    assert float(SCAN_MEASURES["precision"](sums[1])) == 0.5


def test_near_returns_count_as_contact_only_where_asked(make_record: MakeRecord) -> None:
    record = make_record([FAR] * 4)
    record.scans["near_returns"][2] = 7

    assert len(alarms(record, nearest_range(record), 0.2)) == 0
    assert len(alarms(record, nearest_or_near_return(record), 0.2)) == 1


def test_lead_time_runs_from_the_first_alarm_to_the_contact(make_record: MakeRecord) -> None:
    record = make_record([FAR] * 10 + [NEAR] * 20, contacts=[(1.2, 1.5)])

    assert lead_times(record, nearest_range(record), 0.2) == pytest.approx([1.2 - 0.55])
