"""Collision alarms of a distance below a threshold, against contacts: per event and per scan."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring import estimate
from harness.tune.scoring.choose import Count
from harness.tune.scoring.estimate import FN, FP, TN, TP, Counts, Measure, Sums, ratio, share
from rover_metrics.timing import EVENT_GAP_NS, NANOSECONDS

GAP = EVENT_GAP_NS / NANOSECONDS  # [s]: alarms, like contacts, that are closer together are one
CONTACTS, DETECTED, ALARMS, RIGHT, KM = range(5)  # what is counted of an episode's events
NEAREST_RANGE, FOOTPRINT_CLEARANCE = "nearest range", "footprint clearance"

Distances = NDArray[np.float64]  # one per scan [m]; -inf counts as contact whatever the threshold
Detector = Callable[[EpisodeRecord], Distances]


def _distance(column: str, *, near_returns: bool = False) -> Detector:
    """What gives a distance; if near returns count, -inf where a beam met one (REP-117)."""

    def detector(record: EpisodeRecord) -> Distances:
        near = near_returns & (record.scans["near_returns"] > 0)
        return np.where(near, -np.inf, record.scans[column].astype(np.float64))

    return detector


DETECTORS: dict[str, Detector] = {
    NEAREST_RANGE: _distance("nearest"),  # what RoboTerrain compares: the smallest finite range
    f"{NEAREST_RANGE}, near returns count": _distance("nearest", near_returns=True),
    FOOTPRINT_CLEARANCE: _distance("footprint"),  # from a finite return to the rover's outline
    f"{FOOTPRINT_CLEARANCE}, near returns count": _distance("footprint", near_returns=True),
}


def alarms(record: EpisodeRecord, below: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Returns start and end of each run of scans below a threshold, shape (n, 2) [s]."""
    return _alarms(record, below[None])[1]


def _alarms(
    record: EpisodeRecord, below: NDArray[np.bool_]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Returns the alarms of many thresholds: of which one, shape (n,), and as `alarms`, shape (n, 2).

    `below` says which scan is below which threshold, shape (thresholds, scans).
    """
    row, scan = np.nonzero(below)
    times = record.times[scan]
    first = (np.diff(row, prepend=-1) > 0) | (np.diff(times, prepend=-np.inf) > GAP)
    return row[first], np.column_stack((times[first], times[np.roll(first, -1)]))


def matches(record: EpisodeRecord, spans: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Returns which alarm belongs to which contact, shape (alarms, contacts).

    It overlaps the contact or ends at most GAP before it: a scan just before a touch that hides what
    is touched from the next one is no false alarm.
    """
    contacts = record.events
    before = spans[:, 1, None] + GAP >= contacts["start_s"]
    after = spans[:, 0, None] <= contacts["end_s"] + GAP / 10  # the scan that follows its last tick
    return np.asarray(before & after)


def event_counts(detector: Detector) -> Count:
    """Returns what counts contacts, detected ones, alarms, right ones and km of episodes."""

    def count(records: Sequence[EpisodeRecord], thresholds: NDArray[np.float64]) -> Counts:
        counts = np.zeros((len(thresholds), len(records), 5))
        for place, record in enumerate(records):
            row, spans = _alarms(record, detector(record) < thresholds[:, None])
            match = matches(record, spans)
            detected = np.zeros((len(thresholds), len(record.events)), np.bool_)
            np.logical_or.at(detected, row, match)
            counts[:, place, CONTACTS] = len(record.events)
            counts[:, place, DETECTED] = detected.sum(axis=1)
            counts[:, place, ALARMS] = np.bincount(row, minlength=len(thresholds))
            counts[:, place, RIGHT] = np.bincount(row[match.any(axis=1)], minlength=len(thresholds))
            counts[:, place, KM] = record.path_length / 1000.0
        return counts

    return count


def scan_counts(detector: Detector) -> Count:
    """Returns what gives counts of `confusion` of single scans."""
    return lambda records, thresholds: estimate.confusion(
        [(detector(record), record.scans["contact"]) for record in records], thresholds
    )


def lead_times(record: EpisodeRecord, below: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Returns how long before each detected contact its first alarm began, shape (detected,) [s]."""
    spans = alarms(record, below)
    starts = np.where(matches(record, spans), spans[:, :1], np.inf).min(axis=0, initial=np.inf)
    lead = record.events["start_s"] - starts
    return np.asarray(np.maximum(lead[np.isfinite(lead)], 0.0))


_precision, _recall = share(RIGHT, ALARMS), share(DETECTED, CONTACTS)


def _event_f1(sums: Sums) -> NDArray[np.float64]:
    """The harmonic mean of precision (alarms) and recall (contacts); 0 if none is detected."""
    precision, recall = _precision(sums), _recall(sums)
    return np.where(
        precision + recall > 0, ratio(2 * precision * recall, precision + recall), 0 * recall
    )


EVENT_MEASURES: dict[str, Measure] = {
    "F1": _event_f1,
    "precision": _precision,
    "recall": _recall,
    "false alarms per km": lambda sums: ratio(sums[..., ALARMS] - sums[..., RIGHT], sums[..., KM]),
}
SCAN_MEASURES: dict[str, Measure] = {
    "F1": lambda sums: ratio(2 * sums[..., TP], 2 * sums[..., TP] + sums[..., FP] + sums[..., FN]),
    "precision": share(TP, TP, FP),
    "recall": estimate.recall,
    "false positive rate": share(FP, FP, TN),
}
