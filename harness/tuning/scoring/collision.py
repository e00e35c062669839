"""collision_threshold: which distance tells a contact best, beside the default and other detectors."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from harness.tuning.episodes.plan import Part
from harness.tuning.episodes.record import EpisodeRecord
from harness.tuning.scoring.alarms import (
    DETECTORS,
    EVENT_MEASURES,
    SCAN_MEASURES,
    Detector,
    event_counts,
    lead_times,
    scan_counts,
)
from harness.tuning.scoring.baselines import UnseenContacts, ZoneRow, unseen_contacts, zone_rows
from harness.tuning.scoring.choose import Records, Scoring, judged
from harness.tuning.scoring.result import Candidate, Scores, Verdict

PARAMETER, REFERENCE_DETECTOR = "collision_threshold", "nearest range"
GRID = np.round(np.arange(0.02, 1.001, 0.01), 2)  # [m]
FEWEST_CONTACTS = 10  # of each part: fewer do not support a threshold


@dataclass(frozen=True, kw_only=True)
class DetectorStudy:
    """One way to tell contacts from scans, at one threshold.

    Attributes:
        name: Of the detector.
        events: Its threshold and scores per event.
        scans: Its scores per scan on the test half.
        lead_s: Median time from alarm to contact there [s]; None if it finds none.
    """

    name: str
    events: Candidate
    scans: Scores
    lead_s: float | None


@dataclass(frozen=True, kw_only=True)
class CollisionStudy:
    """Everything about the contacts of one robot.

    Attributes:
        verdict: On RoboTerrain's detector.
        default: RoboTerrain's detector at the default.
        detectors: RoboTerrain's and those that the metrics node offers beside it, each at its best;
            empty where the data support none.
        zones: Contacts by side, on the test half.
        unseen_contacts: Contacts that no threshold can tell, and why, on the test half.
        contacts: All contacts of the test half.
    """

    verdict: Verdict
    default: DetectorStudy
    detectors: tuple[DetectorStudy, ...]
    zones: tuple[ZoneRow, ...]
    unseen_contacts: tuple[UnseenContacts, ...]
    contacts: int


def study_collisions(records: Records) -> CollisionStudy:
    """Judges the default and chooses a better value, if the data support one."""
    test = records[Part.TEST]
    lack = _lack(records)
    verdict = judged(PARAMETER, _scoring(DETECTORS[REFERENCE_DETECTOR]), records, lack=lack)
    default = _detector_study(REFERENCE_DETECTOR, records, verdict.default)
    detectors = () if lack is not None else tuple(_at_best(name, records) for name in DETECTORS)
    told = {"default": default} | {study.name: study for study in detectors}
    thresholds = {name: (DETECTORS[study.name], study.events.value) for name, study in told.items()}
    return CollisionStudy(
        verdict=verdict,
        default=default,
        detectors=detectors,
        zones=zone_rows(test, thresholds),
        unseen_contacts=unseen_contacts(test),
        contacts=_contacts(test),
    )


def _scoring(detector: Detector) -> Scoring:
    return Scoring(partial(event_counts, detector), EVENT_MEASURES, "F1", GRID)


def _at_best(name: str, records: Records) -> DetectorStudy:
    scoring = _scoring(DETECTORS[name])
    best = scoring.candidate(records, scoring.best(records[Part.TRAIN]))
    return _detector_study(name, records, best)


def _detector_study(name: str, records: Records, candidate: Candidate) -> DetectorStudy:
    detector, test = DETECTORS[name], records[Part.TEST]
    per_scan = Scoring(partial(scan_counts, detector), SCAN_MEASURES, "F1", GRID)
    leads = [lead_times(record, detector(record), candidate.value) for record in test]
    lead = np.concatenate(leads) if leads else np.empty(0)
    return DetectorStudy(
        name=name,
        events=candidate,
        scans=per_scan.scores(test, candidate.value),
        lead_s=float(np.median(lead)) if lead.size else None,
    )


def _lack(records: Records) -> str | None:
    """Why the data support no value, or None."""
    for part, some in records.items():
        contacts = _contacts(some)
        if contacts < FEWEST_CONTACTS:
            return (
                f"{contacts} contacts with hazards in the {part} episodes; {FEWEST_CONTACTS} are needed"
            )
    return None


def _contacts(records: Sequence[EpisodeRecord]) -> int:
    return sum(len(record.events) for record in records)
