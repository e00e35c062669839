"""collision_threshold: which distance tells a contact best, beside the default and other detectors."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EVENT, EpisodeRecord, Sight, Table, Zone
from harness.tune.scoring import alarms
from harness.tune.scoring.alarms import DETECTORS, EVENT_MEASURES, FOOTPRINT_CLEARANCE, NEAREST_RANGE
from harness.tune.scoring.choose import Candidate, Records, Scores, Scoring, Verdict, judged, lack_of
from harness.tune.scoring.estimate import Counts
from rover_metrics.extended.settings import PARAMETERS

PARAMETER = "collision_threshold"
NEAR_RETURNS, FOOTPRINT_THRESHOLD = "near_returns_as_contact", "footprint_threshold"
GRID = np.round(np.arange(0.02, 1.001, 0.01), 2)  # [m]
SCORINGS = {
    name: Scoring(alarms.event_counts(detector), EVENT_MEASURES, "F1", GRID)
    for name, detector in DETECTORS.items()
}
FOOTPRINT_DETECTORS = {  # by near_returns_as_contact
    False: FOOTPRINT_CLEARANCE,
    True: f"{FOOTPRINT_CLEARANCE}, near returns count",
}
NOTE = "read with extended_columns:=true"
FEWEST_CONTACTS = 10  # of each part: fewer do not support a threshold


@dataclass(frozen=True, kw_only=True)
class DetectorStudy:
    """One way to tell contacts from scans, at one threshold."""

    name: str
    events: Candidate  # its threshold and scores per event
    scans: Scores  # its scores per scan on the test half
    lead_s: float | None  # median time from alarm to contact there [s]; None if it finds none


@dataclass(frozen=True, slots=True)
class UnseenContacts:
    """Contacts that the lidar could not know of, for one reason."""

    sight: Sight
    contacts: int


@dataclass(frozen=True, slots=True)
class ZoneRow:
    """Contacts on one side with hazards that the lidar saw, and how many of them each detector tells."""

    zone: Zone
    contacts: int
    detected: Mapping[str, int]


@dataclass(frozen=True, kw_only=True)
class CollisionStudy:
    """Everything about the contacts of one robot; those that are counted are of the test half.

    Detectors are RoboTerrain's and those that the metrics node offers beside it.
    """

    verdict: Verdict  # on RoboTerrain's detector
    footprint: tuple[Verdict, Verdict]  # on the two parameters of the footprint's collisions
    default: DetectorStudy  # RoboTerrain's detector at the default
    detectors: tuple[DetectorStudy, ...]  # each at its best; empty where the data support none
    zones: tuple[ZoneRow, ...]  # contacts by side
    unseen_contacts: tuple[UnseenContacts, ...]  # that no threshold can detect, and why
    contacts: int  # all of them


def study_collisions(records: Records) -> CollisionStudy:
    """Judges the default and chooses a better value, if the data support one."""
    test = records[Part.TEST]
    thing = "contact", " with hazards"
    lack = lack_of(records, thing, lambda record: len(record.events), FEWEST_CONTACTS)
    verdict = judged(PARAMETER, SCORINGS[NEAREST_RANGE], records, lack=lack)
    default = _detector_study(NEAREST_RANGE, records, verdict.default)
    best = {} if lack else {name: one.best(records[Part.TRAIN]) for name, one in SCORINGS.items()}
    detectors = [
        _detector_study(name, records, SCORINGS[name].candidate(records, value))
        for name, value in best.items()
    ]
    shown = {"default": default} | {study.name: study for study in detectors}
    thresholds = {name: (DETECTORS[study.name], study.events.value) for name, study in shown.items()}
    return CollisionStudy(
        verdict=verdict,
        footprint=_footprint_verdicts(records, lack),
        default=default,
        detectors=tuple(detectors),
        zones=zone_rows(test, thresholds),
        unseen_contacts=unseen_contacts(test),
        contacts=len(_events(test)),
    )


def _footprint_verdicts(records: Records, lack: str | None) -> tuple[Verdict, Verdict]:
    """Judges near returns at the default threshold, then the threshold with what that comes to."""
    default = np.array([PARAMETERS[FOOTPRINT_THRESHOLD].default])

    def count(some: Sequence[EpisodeRecord], switch: NDArray[np.float64]) -> Counts:
        names = (FOOTPRINT_DETECTORS[bool(on)] for on in switch)
        return np.concatenate([SCORINGS[name].count(some, default) for name in names])

    switch = Scoring(count, EVENT_MEASURES, "F1", np.empty(0))
    near = judged(NEAR_RETURNS, switch, records, lack=lack, value=True, note=NOTE)
    scoring = SCORINGS[FOOTPRINT_DETECTORS[near.value is not None]]
    return near, judged(FOOTPRINT_THRESHOLD, scoring, records, lack=lack, note=NOTE)


def zone_rows(
    records: Sequence[EpisodeRecord], detectors: Mapping[str, tuple[alarms.Detector, float]]
) -> tuple[ZoneRow, ...]:
    """Returns how many contacts of each side each detector tells with its threshold [m]."""
    events, detected = _events(records), {}
    for name, (detector, threshold) in detectors.items():
        spans = [alarms.alarms(one, detector(one) < threshold) for one in records]
        each = [alarms.matches(*pair).any(axis=0) for pair in zip(records, spans, strict=True)]
        detected[name] = np.concatenate([np.empty(0, dtype=bool), *each])
    sides = {zone: (events["sight"] == Sight.SEEN) & (events["zone"] == zone) for zone in Zone}
    rows = []
    for zone, here in sides.items():
        counts = {name: int((here & those).sum()) for name, those in detected.items()}
        rows.append(ZoneRow(zone, int(here.sum()), counts))
    return tuple(rows)


def unseen_contacts(records: Sequence[EpisodeRecord]) -> tuple[UnseenContacts, ...]:
    """Returns contacts without a finite return of what was touched, by reason."""
    sights = _events(records)["sight"].tolist()
    return tuple(UnseenContacts(why, sights.count(why)) for why in Sight if why is not Sight.SEEN)


def _events(records: Sequence[EpisodeRecord]) -> Table:
    return np.concatenate([np.empty(0, EVENT), *(record.events for record in records)])


def _detector_study(name: str, records: Records, candidate: Candidate) -> DetectorStudy:
    detector, test = DETECTORS[name], records[Part.TEST]
    per_scan = Scoring(alarms.scan_counts(detector), alarms.SCAN_MEASURES, "F1", GRID)
    leads = (alarms.lead_times(record, detector(record) < candidate.value) for record in test)
    lead = np.concatenate([np.empty(0), *leads])
    return DetectorStudy(
        name=name,
        events=candidate,
        scans=per_scan.scores(test, candidate.value),
        lead_s=float(np.median(lead)) if lead.size else None,
    )
