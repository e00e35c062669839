"""min_safe_clearance: the nearest range at which a rover at top speed can still stop, and its check."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.tuning.episodes.plan import Part
from harness.tuning.episodes.record import EpisodeRecord, Sight, Zone
from harness.tuning.scoring.alarms import (
    ALARMS,
    CONTACTS,
    DETECTED,
    EVENT_MEASURES,
    KM,
    RIGHT,
    alarms,
    nearest_range,
)
from harness.tuning.scoring.braking import LATENCY, Braking, measure_braking
from harness.tuning.scoring.choose import Records, Scoring, judged
from harness.tuning.scoring.estimate import Counts
from harness.tuning.scoring.result import Verdict

PARAMETER, MEASURE = "min_safe_clearance", "F1"
MARGIN = 0.1  # [m] of room that is left when the rover stands
STEP = 0.01  # [m]
HORIZON = 2.0  # [s] in which a contact must follow a warning
MOVING = 0.05  # [m/s]
FEWEST_HEAD_ON = 5


@dataclass(frozen=True, kw_only=True)
class ClearanceStudy:
    """The safe clearance of one robot, and the sum that makes it.

    Attributes:
        overhang: From the lidar to the front end [m].
        braking: The measured stop.
        margin: Added [m].
    """

    verdict: Verdict
    overhang: float
    braking: Braking
    margin: float


def study_clearance(records: Records, rover: RoverSpec, seed: int) -> ClearanceStudy:
    """Computes the clearance and checks it against the contacts that followed."""
    braking = measure_braking(rover, seed)
    overhang = rover.footprint[1] - rover.lidar_x
    value = math.ceil((overhang + braking.stopping_distance + MARGIN) / STEP) * STEP
    scoring = Scoring(partial(_counts, braking), EVENT_MEASURES, MEASURE, np.empty(0))
    note = (
        f"{overhang:.3f} m from lidar to bumper + {braking.speed * LATENCY:.3f} m in {LATENCY:g} s at "
        f"{braking.speed:.2f} m/s + {braking.distance:.3f} m braking + {MARGIN:g} m margin"
    )
    verdict = judged(PARAMETER, scoring, records, lack=_lack(records), value=round(value, 2), note=note)
    return ClearanceStudy(verdict=verdict, overhang=overhang, braking=braking, margin=MARGIN)


def _counts(
    braking: Braking, records: Sequence[EpisodeRecord], thresholds: NDArray[np.float64]
) -> Counts:
    """Head-on contacts, those warned of in time to stop, warnings, those that contacts followed, km."""
    counts = np.zeros((len(thresholds), len(records), 5))
    for place, record in enumerate(records):
        contacts = record.events[_is_head_on(record)]
        needed = np.array([braking.needed_lead(speed) for speed in contacts["speed"]])
        for row, threshold in enumerate(thresholds):
            warnings = alarms(record, nearest_range(record), threshold)
            lead = contacts["start_s"] - warnings[:, :1]  # (warnings, contacts)
            ongoing = contacts["start_s"] <= warnings[:, 1:] + HORIZON
            counts[row, place, CONTACTS] = len(contacts)
            counts[row, place, DETECTED] = ((lead >= needed) & ongoing).any(axis=0).sum()
            counts[row, place, ALARMS] = len(warnings)
            counts[row, place, RIGHT] = _followed(record, warnings)
            counts[row, place, KM] = record.path_length / 1000.0
    return counts


def _lack(records: Records) -> str | None:
    """Why the contacts do not support a value, or None."""
    test = records[Part.TEST]
    contacts = sum(int(np.count_nonzero(_is_head_on(record))) for record in test)
    if contacts < FEWEST_HEAD_ON:
        return (
            f"{contacts} contacts ahead with hazards that the lidar saw in the test episodes; "
            f"{FEWEST_HEAD_ON} are needed to check it"
        )
    return None


def _is_head_on(record: EpisodeRecord) -> NDArray[np.bool_]:
    """Contacts that braking could have avoided and the lidar could have told."""
    events = record.events
    return np.asarray(
        (events["zone"] == Zone.FRONT) & (events["sight"] == Sight.SEEN) & (events["speed"] > MOVING)
    )


def _followed(record: EpisodeRecord, warnings: NDArray[np.float64]) -> int:
    """Warnings during which, or soon after which, any contact began."""
    starts = record.events["start_s"]
    follows = (starts >= warnings[:, :1]) & (starts <= warnings[:, 1:] + HORIZON)
    return int(follows.any(axis=1).sum())
