"""Everything that a sweep says of one robot: in values, and in sentences."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from harness.robots import find_rover, robot_name
from harness.tune.episodes.plan import Part, Planned
from harness.tune.episodes.record import Ending, EpisodeRecord
from harness.tune.scoring.choose import Records, Verdict
from harness.tune.scoring.clearance import ClearanceStudy, study_clearance
from harness.tune.scoring.collision import CollisionStudy, study_collisions
from harness.tune.scoring.distance import DistanceStudy, study_distance
from harness.tune.scoring.estimate import Estimate
from harness.tune.scoring.ground import SIGNALS, GroundStudy, study_ground
from rover_metrics.errors import counted

MATERIAL = 0.05  # of a score: a smaller difference is real, but no default is wrong for it


@dataclass(frozen=True, kw_only=True)
class Driven:
    """What was driven."""

    endings: Mapping[Ending, int]  # episodes by how they ended; those that diverged are not scored
    seconds: float  # simulated time that is scored [s]
    path_length: float  # true path that is scored [m]

    def text(self) -> str:
        """Returns time, path and endings in one line."""
        endings = ", ".join(f"{number} {ending}" for ending, number in sorted(self.endings.items()))
        return f"{self.seconds / 60:.0f} min and {self.path_length / 1000:.2f} km scored; {endings}"


@dataclass(frozen=True, kw_only=True)
class RobotStudy:
    """One robot's thresholds; `robot` is its name, or its folder."""

    robot: str
    driven: Driven
    collision: CollisionStudy
    clearance: ClearanceStudy
    grounds: tuple[GroundStudy, ...]
    distance: DistanceStudy

    @property
    def name(self) -> str:
        """What the robot is called."""
        return robot_name(self.robot)

    @property
    def verdicts(self) -> Iterator[Verdict]:
        """Verdicts on all thresholds, in the order of the page."""
        yield self.collision.verdict
        yield from self.collision.footprint
        yield self.clearance.verdict
        yield from (ground.verdict for ground in self.grounds)
        yield self.distance.verdict


def study(robot: str, records: Mapping[Planned, EpisodeRecord], seed: int) -> RobotStudy:
    """Returns the scores of one robot's thresholds.

    Args:
        robot: Its name.
        records: Episodes of the sweep, those of other robots too.
        seed: Of the sweep.
    """
    rover = find_rover(robot)
    parts = scored_records(robot, records)
    return RobotStudy(
        robot=robot,
        driven=driven(robot, records),
        collision=study_collisions(parts),
        clearance=study_clearance(parts, rover, seed),
        grounds=tuple(study_ground(parts, signal) for signal in SIGNALS),
        distance=study_distance(parts, rover),
    )


def scored_records(robot: str, records: Mapping[Planned, EpisodeRecord]) -> Records:
    """Returns a robot's episodes by part, in the order of the plan, without those that diverged."""
    parts: dict[Part, list[EpisodeRecord]] = {part: [] for part in Part}
    for planned in sorted(records, key=lambda planned: planned.index):
        if planned.run.rover.robot == robot and records[planned].ending is not Ending.DIVERGED:
            parts[planned.part].append(records[planned])
    return parts


def driven(robot: str, records: Mapping[Planned, EpisodeRecord]) -> Driven:
    """Returns how much of a sweep one robot drove, and how its episodes ended."""
    own = [record for planned, record in records.items() if planned.run.rover.robot == robot]
    scored = [record for record in own if record.ending is not Ending.DIVERGED]
    return Driven(
        endings=dict(Counter(record.ending for record in own)),
        seconds=sum(record.duration for record in scored),
        path_length=sum(record.path_length for record in scored),
    )


def conclusions(study: RobotStudy) -> Iterator[str]:
    """Yields what a user must know of a robot, a sentence or two for each matter."""
    for verdict in study.verdicts:
        yield judgement(study.name, verdict)
    yield unreachable(study.collision)
    yield from alternatives(study.collision)


def judgement(robot: str, verdict: Verdict) -> str:
    """Returns whether the default of a threshold suits a robot."""
    default = f"{verdict.name}: the default {verdict.written(verdict.default)}"
    if verdict.tuned is None:
        return f"{default} stays for {robot}, because the data support no value: {verdict.lack}."
    tuned, digits = verdict.written(verdict.tuned), verdict.digits
    was = verdict.default.scores[Part.TEST][verdict.measure]
    becomes = verdict.tuned.scores[Part.TEST][verdict.measure]
    gain = verdict.gain[verdict.measure]
    note = f" ({verdict.note})" if verdict.note else ""
    scores = (
        f"{verdict.measure} {was.text(digits)} against {becomes.text(digits)} with {tuned}{note} on "
        "unseen seeds"
    )
    if verdict.value is None:
        return (
            f"{default} stays for {robot}, for nothing better is proven: {scores}; on the same episodes "
            f"the difference is {gain.text(digits)}."
        )
    if verdict.is_proven:
        return f"{default} is {_how_bad(gain)} for {robot}: {scores}; the intervals do not overlap."
    return (
        f"{default} is worse than {tuned} for {robot}: {scores}; the intervals overlap, but on the same "
        f"episodes the difference is {gain.text(digits)}."
    )


def _how_bad(gain: Estimate) -> str:
    """What the whole interval of a difference says of the default, not its middle alone."""
    if gain.low is not None and gain.low >= MATERIAL:
        return "wrong"
    little = "a little " if gain.high is not None and gain.high < MATERIAL else ""
    return f"{little}worse than it could be"


def unreachable(study: CollisionStudy) -> str:
    """Returns the sentence on contacts that no threshold can tell."""
    blind = [spot for spot in study.unseen_contacts if spot.contacts]
    total = sum(spot.contacts for spot in blind)
    if not study.contacts:
        return "No contact took place in the episodes that check."
    if not total:
        one = study.contacts == 1
        hazards = "hazard that was" if one else f"{study.contacts} hazards that were"
        return f"The lidar saw {'the' if one else 'every one of the'} {hazards} touched."
    reasons = ", ".join(f"{spot.contacts} {spot.sight}" for spot in blind)
    share = 100.0 * total / study.contacts
    return (
        f"No threshold can tell {total} of {counted(study.contacts, 'contact')} ({share:.0f} %), for "
        f"the lidar did not see the hazard: {reasons}."
    )


def alternatives(study: CollisionStudy) -> Iterator[str]:
    """Yields what the other detectors of the metrics node gain."""
    for detector in study.detectors[1:]:
        scores = detector.events.scores[Part.TEST]
        yield (
            f"{detector.name.capitalize()} below {detector.events.value:g} m: F1 {scores['F1'].text()}, "
            f"recall {scores['recall'].text()}, "
            f"{scores['false alarms per km'].text(1)} false alarms per km."
        )
