"""Alarms against contacts."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.metrics import confusion_matrix, f1_score, precision_score, recall_score

from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring.alarms import (
    DETECTORS,
    EVENT_MEASURES,
    NEAREST_RANGE,
    SCAN_MEASURES,
    alarms,
    event_counts,
    lead_times,
    matches,
    scan_counts,
)

MakeRecord = Callable[..., EpisodeRecord]

nearest_range = DETECTORS[NEAREST_RANGE]
FAR, NEAR = 3.0, 0.1875


def near_at(make_record: MakeRecord, *times: float, **more: object) -> EpisodeRecord:
    """Four seconds with a hazard nearby only in the scans at these times [s]."""
    ranges = np.full(80, FAR)
    ranges[[round(time * 20) - 1 for time in times]] = NEAR
    return make_record(ranges, **more)


def found_in(record: EpisodeRecord) -> NDArray[np.float64]:
    return alarms(record, nearest_range(record) < 0.2)


@pytest.mark.parametrize(("gap_ms", "expected"), [(500, 1), (501, 2)])
def test_alarms_half_a_second_apart_are_one(make_record: MakeRecord, gap_ms: int, expected: int) -> None:
    record = make_record([NEAR] * 3)
    record.scans["stamp_ms"] = (1000, 1250, 1250 + gap_ms)
    found = found_in(record)
    ends = [[1.0, 1.25], [1.25 + gap_ms / 1e3] * 2] if expected == 2 else [[1.0, 1.75]]
    assert found == pytest.approx(np.array(ends))


@pytest.mark.parametrize(
    ("start", "end", "belongs"),
    [
        (1.0, 1.499, False),  # too long before the contact
        (1.0, 1.5, True),  # half a second before: what is touched may be too near to be seen
        (2.05, 2.1, True),
        (2.25, 2.3, True),  # the scan that follows the last tick
        (2.251, 2.3, False),
        (1.0, 3.0, True),
    ],
)
def test_which_alarm_belongs_to_a_contact(
    make_record: MakeRecord, start: float, end: float, *, belongs: bool
) -> None:
    record = make_record([], contacts=[(2.0, 2.2), (9.0, 9.1)])
    assert matches(record, np.array([[start, end]])).tolist() == [[belongs, False]]


def test_contacts_found_and_alarms_that_are_right_are_counted_apart(make_record: MakeRecord) -> None:
    # One long alarm over two contacts, three false ones, and a contact that none tells.
    long = [round(0.05 * n, 2) for n in range(20, 31)]
    record = near_at(make_record, 0.1, *long, 2.6, 3.9, contacts=[(1.0, 1.1), (1.4, 1.5), (2.1, 2.15)])
    other = near_at(make_record, 2.0)
    counts = event_counts(nearest_range)([record, other], np.array([NEAR, 0.2, FAR]))  # strict
    assert counts.shape == (3, 2, 5)
    assert counts[0].tolist() == [[3, 0, 0, 0, 0.004], [0, 0, 0, 0, 0.004]]
    assert counts[1].tolist() == [[3, 2, 4, 1, 0.004], [0, 0, 1, 0, 0.004]]
    assert counts[2].tolist() == counts[1].tolist()
    nan = np.nan  # precision without alarms; recall, and so F1, without contacts
    expected = {
        "F1": [[0.0, nan], [2 / (4 / 1 + 3 / 2), nan]],  # the harmonic mean
        "precision": [[nan, nan], [1 / 4, 0.0]],
        "recall": [[0.0, nan], [2 / 3, nan]],
        "false alarms per km": [[0.0, 0.0], [3 / 0.004, 1 / 0.004]],
    }
    assert list(EVENT_MEASURES) == list(expected)
    for name, measure in EVENT_MEASURES.items():
        np.testing.assert_allclose(measure(counts[:2]), expected[name], err_msg=name)


def test_scans_are_scored_as_scikit_learn_does(make_record: MakeRecord) -> None:
    rng = np.random.default_rng(0)
    record = make_record(np.round(rng.uniform(0.0, 1.0, 200), 1))
    record.scans["contact"] = rng.random(200) < 0.3
    nearest, truth = nearest_range(record), record.scans["contact"]
    counts = scan_counts(nearest_range)([record, record], np.array([nearest[0], 0.45]))[:, 0]
    for row, threshold in zip(counts, (nearest[0], 0.45), strict=True):
        says = nearest < threshold  # strict, also where a scan is as near as the threshold
        tn, fp, fn, tp = confusion_matrix(truth, says).ravel().tolist()
        assert row.tolist() == [tp, fp, fn, tn]
        assert {name: float(measure(row)) for name, measure in SCAN_MEASURES.items()} == pytest.approx(
            {
                "F1": f1_score(truth, says),
                "precision": precision_score(truth, says),
                "recall": recall_score(truth, says),
                "false positive rate": fp / (fp + tn),
            }
        )


def test_lead_time_runs_from_the_first_alarm_to_each_contact(
    make_record: MakeRecord,
) -> None:
    # Told by two alarms; told only once it has begun; not told.
    record = near_at(make_record, 0.5, 0.55, 1.1, 2.2, contacts=[(1.0, 1.1), (2.0, 2.3), (3.5, 3.6)])
    assert lead_times(record, nearest_range(record) < 0.2) == pytest.approx([0.5, 0.0])
    assert lead_times(record, nearest_range(record) < 0.1).size == 0
