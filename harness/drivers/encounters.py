"""Drivers that meet hazards on purpose: drive up, line up, act, leave, and on to the next one.

There are five ways: head on, in reverse, grazing, swinging round beside it, just missing it.

They know where the hazards are, which no rover does: they exist to produce contacts and near misses
of every kind for `harness.tune`, not to drive well.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

from harness.base.errors import UsageError
from harness.base.sim_time import CONTROL_PERIOD
from harness.drivers.base import DriverContext, Observation, turning
from harness.samples import Sample, Twist
from harness.world.obstacles import Obstacle, ObstacleKind, half_extent
from harness.world.terrains import WITH_HAZARDS

Point = tuple[float, float]

BORDER = 2.0  # [m] along the map's edge where no hazard is visited
NEAREST = 4  # hazards to choose from
SPREAD = 0.5  # [rad]: how much the direction of approach varies
RUN_UP = 1.2  # [m] of straight line before the hazard
ARRIVED, LINED_UP = 0.25, 0.06  # [m], [rad]
GO_PATIENCE, FACE_PATIENCE = 20.0, 6.0  # [s]
LOOKAHEAD = 0.5  # [m] along the line within which the rover steers back onto it
PUSHING = (0.05, 0.4)  # [s] in contact before it leaves: soon its wheels would climb and tip it over
LEAVING = 1.5  # [s]
SLOWEST, FASTEST = 0.25, 0.9  # of the rover's top speed
HEAD_ON = 0.6  # of the width within which rover and hazard meet
GRAZE_OVERLAP = (0.0, 0.08)  # [m] by which the rover's side would enter the hazard
PASSING_GAP = (0.04, 0.5)  # [m] between the rover's side and the hazard
SWING_GAP = (0.0, 0.1)  # [m], less than what the corners stand out beyond the sides when turning
SWING_TIME = 3.0  # [s]


@dataclass(frozen=True, slots=True)
class Meeting:
    """One planned encounter, along a directed line past a hazard."""

    beside: Point  # where the line passes the hazard's middle [m]
    course: float  # direction of the line [rad]
    speed: float  # along it [m/s]; negative backwards
    reach: float  # half the hazard's length along the line [m]

    @property
    def heading(self) -> float:
        """Heading of the rover while it acts [rad]."""
        return self.course + (math.pi if self.speed < 0.0 else 0.0)

    def along(self, point: Point) -> float:
        """Returns how far past the hazard's middle a point lies [m]."""
        dx, dy = point[0] - self.beside[0], point[1] - self.beside[1]
        return dx * math.cos(self.course) + dy * math.sin(self.course)

    def aside(self, point: Point) -> float:
        """Returns how far to the left of the line a point lies [m]."""
        dx, dy = point[0] - self.beside[0], point[1] - self.beside[1]
        return dy * math.cos(self.course) - dx * math.sin(self.course)

    def at(self, distance: float) -> Point:
        """Returns the point of the line so far past the hazard's middle [m]."""
        x, y = self.beside
        return x + distance * math.cos(self.course), y + distance * math.sin(self.course)


class StagedEncounter(ABC):
    """Goes from hazard to hazard; a subclass says how each is met."""

    summary: ClassVar[str]
    senses: ClassVar[frozenset[type[Sample]]] = frozenset()

    def __init__(self, context: DriverContext) -> None:
        self.rover, self.rng = context.rover, context.rng
        self._hazards = self.hazards(context.obstacles, context.half_size, context.middle)
        self._now = Observation(time_ns=0, x=0.0, y=0.0, yaw=0.0, ranges=None)
        self._script = self._visits()

    @classmethod
    def hazards(cls, obstacles: Sequence[Obstacle], half_size: Point, middle: Point) -> list[Obstacle]:
        """Returns those that it visits.

        Args:
            obstacles: What stands in the world.
            half_size: Half the lengths of the map along x and y [m].
            middle: Of the map [m].

        Raises:
            UsageError: There is none; the message names terrains that have some.
        """
        (x, y), (reach_x, reach_y) = middle, (half - BORDER for half in half_size)
        places = ((o, o.position) for o in obstacles)
        within = [o for o, at in places if abs(at[0] - x) < reach_x and abs(at[1] - y) < reach_y]
        if hazards := [o for o in within if o.kind is ObstacleKind.HAZARD]:
            return hazards
        raise UsageError(
            f"it {cls.summary.partition(' (')[0]}, and none stands {BORDER:g} m or more from the edge; "
            f"terrains with hazards: {', '.join(WITH_HAZARDS)}"
        )

    @abstractmethod
    def offset(self, width: float) -> float:
        """Returns how far left of a hazard's middle to pass [m]; nearer than `width` they meet."""

    def plan(self, hazard: Obstacle, bearing: float) -> Meeting:
        """Returns how to meet a hazard that lies in about that direction [rad] of the world."""
        course = bearing + self.rng.normal(0.0, SPREAD)
        offset = self.offset(half_extent(hazard, course + math.pi / 2) + self.rover.width / 2)
        x, y, _ = hazard.position
        beside = x - offset * math.sin(course), y + offset * math.cos(course)
        return Meeting(beside, course, self.random_speed(), half_extent(hazard, course))

    def act(self, meeting: Meeting) -> Iterator[Twist]:
        """What happens once the rover is lined up: along the line, past the hazard or into it."""
        yield from self.follow(meeting, meeting.reach + RUN_UP / 2)

    def command(self, observation: Observation) -> Twist:
        """Returns the next twist of the script."""
        self._now = observation
        return next(self._script)

    @property
    def here(self) -> Point:
        """Position of the rover in the world [m]."""
        return self._now.x, self._now.y

    def follow(self, meeting: Meeting, until: float) -> Iterator[Twist]:
        """Drives along a meeting's line to `until` metres past the hazard's middle, or for a push."""
        patience = self.rng.uniform(*PUSHING)
        while meeting.along(self.here) < until and patience > 0.0:
            correction = math.atan2(-meeting.aside(self.here), LOOKAHEAD)
            # In reverse the tail leads, and the same turn brings it onto the line.
            yield Twist(meeting.speed, self._yaw_rate(self._now.turn_to(meeting.heading + correction)))
            patience -= self._now.touches_hazard * CONTROL_PERIOD

    def spin(self, seconds: float, rate: float) -> Iterator[Twist]:
        """Turns in place, until it touches something."""
        for _ in range(round(seconds / CONTROL_PERIOD)):
            if self._now.touches_hazard:
                return
            yield Twist(0.0, rate)

    def random_speed(self) -> float:
        """Returns a speed that the rover can drive [m/s]."""
        return self.rng.uniform(SLOWEST, FASTEST) * self.rover.top_speed

    def _visits(self) -> Iterator[Twist]:
        last: Obstacle | None = None
        while True:
            hazard = last = self._next_hazard(last)
            (x, y, _), here = hazard.position, self.here
            meeting = self.plan(hazard, math.atan2(y - here[1], x - here[0]))
            start = meeting.at(-(meeting.reach + self.rover.length / 2 + RUN_UP))
            yield from self._go(start)
            if math.dist(self.here, start) < 2 * ARRIVED:
                yield from self._face(meeting.heading)
                yield from self.act(meeting)
            away = -0.5 * math.copysign(self.rover.cruise_speed, meeting.speed)
            for _ in range(round(LEAVING / CONTROL_PERIOD)):
                yield Twist(away)

    def _next_hazard(self, last: Obstacle | None) -> Obstacle:
        others = [h for h in self._hazards if h is not last] or self._hazards
        nearest = sorted(others, key=lambda h: math.dist(h.position[:2], self.here))[:NEAREST]
        return nearest[int(self.rng.integers(len(nearest)))]

    def _go(self, goal: Point) -> Iterator[Twist]:
        for _ in range(round(GO_PATIENCE / CONTROL_PERIOD)):
            if math.dist(goal, self.here) < ARRIVED or self._now.touches_hazard:
                return
            error = self._now.bearing_to(*goal)
            yield Twist(self.rover.cruise_speed * max(0.0, math.cos(error)), self._yaw_rate(error))

    def _face(self, heading: float) -> Iterator[Twist]:
        for _ in range(round(FACE_PATIENCE / CONTROL_PERIOD)):
            error = self._now.turn_to(heading)
            if abs(error) < LINED_UP:
                return
            yield Twist(0.0, self._yaw_rate(error))

    def _yaw_rate(self, error: float) -> float:
        return turning(error, self.rover, 2.5)


class Ram(StagedEncounter):
    """Drives straight into the hazard."""

    summary: ClassVar[str] = "drives into hazards head on (knowing where they are)"

    def offset(self, width: float) -> float:
        """Returns the offset of the path from the hazard's middle, to the left [m]: little or none."""
        return self.rng.uniform(-HEAD_ON, HEAD_ON) * width


class ReverseInto(Ram):
    """Drives backwards into the hazard."""

    summary: ClassVar[str] = "drives into hazards backwards (knowing where they are)"

    def random_speed(self) -> float:
        """Returns a negative speed [m/s]."""
        return -super().random_speed()


class PassBy(StagedEncounter):
    """Passes the hazard closely without touching it."""

    summary: ClassVar[str] = "passes hazards closely without touching (knowing where they are)"
    gap: ClassVar[tuple[float, float]] = PASSING_GAP

    def offset(self, width: float) -> float:
        """Returns the offset of the path from the hazard's middle, to the left [m]: on a random side."""
        side = math.copysign(1.0, self.rng.uniform(-1.0, 1.0))
        return side * (width + self.rng.uniform(*self.gap))


class Graze(PassBy):
    """Scrapes along the hazard's flank."""

    summary: ClassVar[str] = "scrapes along hazards with its side (knowing where they are)"
    gap: ClassVar[tuple[float, float]] = (-GRAZE_OVERLAP[1], -GRAZE_OVERLAP[0])


class Swing(PassBy):
    """Stops beside the hazard and turns: the rover's corners reach farther than its sides."""

    summary: ClassVar[str] = "turns in place beside hazards (knowing where they are)"
    gap: ClassVar[tuple[float, float]] = SWING_GAP

    def act(self, meeting: Meeting) -> Iterator[Twist]:
        """Stops beside the hazard's middle and turns one way, then the other."""
        yield from self.follow(meeting, 0.0)
        for rate in (self.rover.cruise_yaw_rate, -self.rover.cruise_yaw_rate):
            yield from self.spin(SWING_TIME, rate)
