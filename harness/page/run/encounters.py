"""Where people and rover met: of each time that somebody was near, the nearest moment."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from harness.page.run.recorder import Approach, Stretch
from rover_metrics.analysis.social.metrics import ZONES

NEAR = ZONES["social"]  # [m]
MOST_ENCOUNTERS = 30  # that a page can show


@dataclass(frozen=True)
class Encounter:
    """A time at which a person was near; for one who never was, the nearest moment."""

    person: int  # in the order of the world's people
    nearest: Approach  # the moment at which the rover was nearest to them
    near_s: float  # how long the rover was within NEAR of them [s]


def encounters(track: Sequence[Stretch]) -> list[Encounter]:
    """Returns the nearest MOST_ENCOUNTERS, one of each person at least, in the order of time."""
    people = max((len(stretch.approaches) for stretch in track), default=0)
    by_person = [_of_person(track, number) for number in range(people)]
    nearest = [min(some, key=_distance) for some in by_person]
    others = sorted((encounter for some in by_person for encounter in some), key=_distance)
    chosen = {id(e): e for e in (*nearest, *others[: max(0, MOST_ENCOUNTERS - people)])}
    return sorted(chosen.values(), key=lambda e: (e.nearest.time_s, e.person))


def _of_person(track: Sequence[Stretch], number: int) -> list[Encounter]:
    starts = [0.0, *(stretch.time_s for stretch in track)]
    known = [
        (stretch.time_s - start_s, stretch.approaches[number])
        for start_s, stretch in zip(starts, track, strict=False)
        if stretch.approaches
    ]
    times = [[*some] for is_near, some in groupby(known, lambda one: one[1].distance < NEAR) if is_near]
    met: list[Encounter] = []
    for some in times or [known]:
        nearest = min((approach for _, approach in some), key=lambda approach: approach.distance)
        met.append(Encounter(number, nearest, sum(seconds for seconds, _ in some) if times else 0.0))
    return met


def _distance(encounter: Encounter) -> float:
    return encounter.nearest.distance
