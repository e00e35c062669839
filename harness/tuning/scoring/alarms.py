"""Collision alarms of a distance below a threshold, against contacts: per event and per scan."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.scoring.estimate import (
    FN,
    FP,
    TN,
    TP,
    Counts,
    Measure,
    Sums,
    confusion,
    ratio,
    recall,
)

GAP = 0.5  # [s]: alarms, like contacts, that are closer together are one
# What is counted of an episode.
CONTACTS, DETECTED, ALARMS, RIGHT, KM = range(5)  # events

Distances = NDArray[np.float64]  # one per scan [m]; -inf counts as contact whatever the threshold
Detector = Callable[[EpisodeRecord], Distances]


def nearest_range(record: EpisodeRecord) -> Distances:
    """Returns what RoboTerrain compares: the smallest finite range of each scan."""
    return record.scans["nearest"].astype(np.float64)


def nearest_or_near_return(record: EpisodeRecord) -> Distances:
    """Returns the nearest range, -inf where a beam met something nearer than range_min (REP-117)."""
    return np.where(record.scans["near_returns"] > 0, -np.inf, nearest_range(record))


def footprint_clearance(record: EpisodeRecord) -> Distances:
    """Returns the smallest distance from a finite return to the rover's outline, scan by scan."""
    return record.scans["footprint"].astype(np.float64)


def footprint_or_near_return(record: EpisodeRecord) -> Distances:
    """Returns the footprint clearance, -inf where a beam met something nearer than range_min."""
    return np.where(record.scans["near_returns"] > 0, -np.inf, footprint_clearance(record))


DETECTORS: dict[str, Detector] = {
    "nearest range": nearest_range,
    "nearest range, near returns count": nearest_or_near_return,
    "footprint clearance": footprint_clearance,
    "footprint clearance, near returns count": footprint_or_near_return,
}


def alarms(record: EpisodeRecord, distances: Distances, threshold: float) -> NDArray[np.float64]:
    """Returns start and end of each run of scans below a threshold, shape (n, 2) [s]."""
    times = record.times[distances < threshold]
    if times.size == 0:
        return np.empty((0, 2))
    breaks = np.flatnonzero(np.diff(times) > GAP)
    starts = times[np.concatenate(([0], breaks + 1))]
    ends = times[np.concatenate((breaks, [times.size - 1]))]
    return np.column_stack((starts, ends))


def matches(record: EpisodeRecord, found: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Returns which alarm belongs to which contact, shape (alarms, contacts).

    It overlaps the contact or ends at most GAP before it: a scan just before a touch that hides what
    is touched from the next one is no false alarm.
    """
    contacts = record.events
    before = found[:, 1, None] + GAP >= contacts["start_s"]
    after = found[:, 0, None] <= contacts["end_s"] + GAP / 10  # the scan that follows its last tick
    return np.asarray(before & after)


def event_counts(
    detector: Detector, records: Sequence[EpisodeRecord], thresholds: NDArray[np.float64]
) -> Counts:
    """Returns contacts, detected ones, alarms, right ones, km: shape (thresholds, episodes, 5)."""
    counts = np.zeros((len(thresholds), len(records), 5))
    for place, record in enumerate(records):
        distances = detector(record)
        for row, threshold in enumerate(thresholds):
            found = alarms(record, distances, threshold)
            match = matches(record, found)
            counts[row, place] = (
                len(record.events),
                match.any(axis=0).sum(),
                len(found),
                match.any(axis=1).sum(),
                record.path_length / 1000.0,
            )
    return counts


def scan_counts(
    detector: Detector, records: Sequence[EpisodeRecord], thresholds: NDArray[np.float64]
) -> Counts:
    """Returns counts of `confusion`, shape (thresholds, episodes, 4)."""
    return confusion([(detector(record), record.scans["contact"]) for record in records], thresholds)


def lead_times(record: EpisodeRecord, distances: Distances, threshold: float) -> NDArray[np.float64]:
    """Returns how long before each detected contact its first alarm began, shape (detected,) [s]."""
    found = alarms(record, distances, threshold)
    match = matches(record, found)
    starts = np.where(match, found[:, :1], np.inf).min(axis=0, initial=np.inf)
    lead = record.events["start_s"] - starts
    return np.asarray(np.maximum(lead[np.isfinite(lead)], 0.0))


def _precision(sums: Sums) -> NDArray[np.float64]:
    return ratio(sums[..., RIGHT], sums[..., ALARMS])


def _recall(sums: Sums) -> NDArray[np.float64]:
    return ratio(sums[..., DETECTED], sums[..., CONTACTS])


def event_f1(sums: Sums) -> NDArray[np.float64]:
    """Returns the harmonic mean of precision (alarms) and recall (contacts); 0 if none is detected."""
    precision, recall = np.nan_to_num(_precision(sums)), _recall(sums)
    return np.where(
        precision + recall > 0, ratio(2 * precision * recall, precision + recall), 0 * recall
    )


EVENT_MEASURES: dict[str, Measure] = {
    "F1": event_f1,
    "precision": _precision,
    "recall": _recall,
    "false alarms per km": lambda sums: ratio(sums[..., ALARMS] - sums[..., RIGHT], sums[..., KM]),
}
SCAN_MEASURES: dict[str, Measure] = {
    "F1": lambda sums: ratio(2 * sums[..., TP], 2 * sums[..., TP] + sums[..., FP] + sums[..., FN]),
    "precision": lambda sums: ratio(sums[..., TP], sums[..., TP] + sums[..., FP]),
    "recall": recall,
    "false positive rate": lambda sums: ratio(sums[..., FP], sums[..., FP] + sums[..., TN]),
}
