"""Everything that a sweep says of one robot."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from harness.robots import find_rover
from harness.tuning.episodes.plan import Part, Planned
from harness.tuning.episodes.record import Ending, EpisodeRecord
from harness.tuning.scoring.clearance import ClearanceStudy, study_clearance
from harness.tuning.scoring.collision import CollisionStudy, study_collisions
from harness.tuning.scoring.distance import DistanceStudy, study_distance
from harness.tuning.scoring.ground import GroundStudy, study_ground
from harness.tuning.scoring.imu_events import SIGNALS
from harness.tuning.scoring.result import Verdict


@dataclass(frozen=True, kw_only=True)
class Driven:
    """What was driven.

    Attributes:
        endings: Episodes by how they ended; those that diverged are not scored.
        seconds: Simulated time that is scored [s]; `path_length` [m] likewise.
    """

    endings: Mapping[Ending, int]
    seconds: float
    path_length: float

    def text(self) -> str:
        """In a line."""
        endings = ", ".join(f"{number} {ending}" for ending, number in sorted(self.endings.items()))
        return f"{self.seconds / 60:.0f} min and {self.path_length / 1000:.2f} km scored; {endings}"


@dataclass(frozen=True, kw_only=True)
class RobotStudy:
    """One robot's thresholds."""

    robot: str
    driven: Driven
    collision: CollisionStudy
    clearance: ClearanceStudy
    grounds: tuple[GroundStudy, ...]
    distance: DistanceStudy

    @property
    def verdicts(self) -> Iterator[Verdict]:
        """Of all thresholds."""
        yield self.collision.verdict
        yield self.clearance.verdict
        yield from (ground.verdict for ground in self.grounds)
        yield self.distance.verdict


def study(robot: str, records: Mapping[Planned, EpisodeRecord], seed: int) -> RobotStudy:
    """Scores the thresholds of one robot on its episodes of a sweep."""
    rover = find_rover(robot)
    mine = {planned: record for planned, record in records.items() if planned.config.robot == robot}
    parts = {part: _scored(mine, part) for part in Part}
    return RobotStudy(
        robot=robot,
        driven=_driven(list(mine.values())),
        collision=study_collisions(parts),
        clearance=study_clearance(parts, rover, seed),
        grounds=tuple(study_ground(parts, signal) for signal in SIGNALS),
        distance=study_distance(parts, rover),
    )


def _scored(records: Mapping[Planned, EpisodeRecord], part: Part) -> list[EpisodeRecord]:
    return [
        record
        for planned, record in sorted(records.items(), key=lambda item: item[0].index)
        if planned.part is part and record.ending is not Ending.DIVERGED
    ]


def _driven(records: Sequence[EpisodeRecord]) -> Driven:
    scored = [record for record in records if record.ending is not Ending.DIVERGED]
    return Driven(
        endings=dict(Counter(record.ending for record in records)),
        seconds=sum(record.duration for record in scored),
        path_length=sum(record.path_length for record in scored),
    )
