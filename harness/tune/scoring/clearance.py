"""min_safe_clearance: the nearest range at which a rover at top speed can still stop, and its check."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import CONTROL_PERIOD
from harness.robots import RoverSpec
from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord, Sight, Zone
from harness.tune.scoring.alarms import DETECTORS, EVENT_MEASURES, NEAREST_RANGE, alarms
from harness.tune.scoring.choose import Records, Scoring, Verdict, judged, lack_of
from harness.tune.scoring.estimate import Counts
from harness.validate.driving import straight
from harness.validate.grounds import floor
from harness.validate.rig import Rig

PARAMETER, MEASURE = "min_safe_clearance", "F1"
SCAN_PERIOD = 0.05  # [s]
LATENCY = SCAN_PERIOD + CONTROL_PERIOD  # [s] from what is there to a command that answers it, at worst
FLOOR_SPEED = 2.0  # [m/s]: faster, a rover leaves the floor of 12 m before it has stopped
STANDSTILL, LONGEST_STOP = 0.01, 5.0  # [m/s], [s]
MARGIN = 0.1  # [m] of room that is left when the rover stands
STEP = 0.01  # [m]
HORIZON = 2.0  # [s] in which a contact must follow a warning
MOVING = 0.05  # [m/s]
FEWEST_HEAD_ON = 5


@dataclass(frozen=True, slots=True)
class Braking:
    """A stop from top speed on level ground."""

    speed: float  # top speed, measured [m/s]
    distance: float  # from the command to the standstill [m]
    time: float  # from the command to the standstill [s]

    @property
    def stopping_distance(self) -> float:
        """Braking distance, with what is driven before the command comes [m]."""
        return self.speed * LATENCY + self.distance

    def needed_lead(self, speed: float) -> float:
        """Returns how long before a contact at constant speed [m/s] the warning must come [s].

        The stopping distance over the speed: deceleration is constant, so braking from a lower speed
        takes less time in proportion, and half the way of driving on.
        """
        return LATENCY + self.time * min(1.0, speed / self.speed) / 2


@dataclass(frozen=True, kw_only=True)
class ClearanceStudy:
    """The safe clearance of one robot, and the sum that makes it."""

    verdict: Verdict
    overhang: float  # from the lidar to the front end [m]
    braking: Braking  # as measured
    margin: float  # added [m]


def study_clearance(records: Records, rover: RoverSpec, seed: int) -> ClearanceStudy:
    """Computes the clearance and checks it against the contacts that followed.

    Args:
        records: Episodes of the rover, by part.
        rover: Its braking is measured.
        seed: Of that measurement.
    """
    braking = measure_braking(rover, seed)
    overhang = rover.footprint[1] - rover.lidar_x
    value = math.ceil((overhang + braking.stopping_distance + MARGIN) / STEP) * STEP
    scoring = Scoring(partial(_counts, braking), EVENT_MEASURES, MEASURE, np.empty(0))
    note = (
        f"{overhang:.3f} m from lidar to bumper + {braking.speed * LATENCY:.3f} m in {LATENCY:g} s at "
        f"{braking.speed:.2f} m/s + {braking.distance:.3f} m braking + {MARGIN:g} m margin"
    )
    thing, test = ("contact", " ahead with hazards that the lidar saw"), {Part.TEST: records[Part.TEST]}
    lack = lack_of(test, thing, lambda record: int(_is_head_on(record).sum()), FEWEST_HEAD_ON)
    lack = lack and f"{lack} to check it"
    verdict = judged(PARAMETER, scoring, records, lack=lack, value=round(value, 2), note=note)
    return ClearanceStudy(verdict=verdict, overhang=overhang, braking=braking, margin=MARGIN)


def measure_braking(rover: RoverSpec, seed: int) -> Braking:
    """Drives up to top speed on a level floor, as far as that is large enough, and stops."""
    rig = Rig(rover, floor(seed))
    # More than the wheels can do would have to be unwound first.
    fastest = min(rover.wheel_speed_limit * rover.controller_radius, FLOOR_SPEED)
    speed, _ = straight(rig, fastest)
    start, began = rig.stance.ahead, rig.simulation.time_ns
    rig.command(0.0)
    rig.run_until(lambda: rig.speed < STANDSTILL, LONGEST_STOP)
    seconds = (rig.simulation.time_ns - began) / 1e9
    return Braking(speed, rig.stance.ahead - start, seconds)


def _counts(
    braking: Braking, records: Sequence[EpisodeRecord], thresholds: NDArray[np.float64]
) -> Counts:
    """Head-on contacts, those warned of in time to stop, warnings, those that contacts followed, km."""
    counts = np.zeros((len(thresholds), len(records), 5))
    for place, record in enumerate(records):
        contacts, ranges = record.events[_is_head_on(record)], DETECTORS[NEAREST_RANGE](record)
        starts = record.events["start_s"]  # of contacts of any kind
        needed = np.array([braking.needed_lead(speed) for speed in contacts["speed"]])
        for row, threshold in enumerate(thresholds):
            warnings = alarms(record, ranges < threshold)
            lead = contacts["start_s"] - warnings[:, :1]  # (warnings, contacts)
            ongoing = contacts["start_s"] <= warnings[:, 1:] + HORIZON
            follow = (starts >= warnings[:, :1]) & (starts <= warnings[:, 1:] + HORIZON)
            warned, right = ((lead >= needed) & ongoing).any(axis=0).sum(), follow.any(axis=1).sum()
            km = record.path_length / 1000.0
            counts[row, place] = len(contacts), warned, len(warnings), right, km
    return counts


def _is_head_on(record: EpisodeRecord) -> NDArray[np.bool_]:
    """Contacts that braking could have avoided and the lidar could have seen."""
    events = record.events
    return np.asarray(
        (events["zone"] == Zone.FRONT) & (events["sight"] == Sight.SEEN) & (events["speed"] > MOVING)
    )
