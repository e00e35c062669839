"""The people of a world: bodies whose walks are checked against the map, and looked at for hazards."""

import math
from dataclasses import dataclass

import numpy as np

from harness.base.errors import UsageError
from harness.base.streams import PEOPLE, generator
from harness.world.actors.free_space import FreeSpace, along
from harness.world.actors.people import Pedestrian
from harness.world.actors.random_walk import RandomWalk, RandomWalker
from harness.world.actors.route import Route, timed
from harness.world.actors.social_force import SocialForceWalker
from harness.world.obstacles import Points

Walk = Route | RandomWalker | SocialForceWalker

LONGEST = 200_000.0  # [m] of a route one way, which is looked at every 10 cm
CHECKED_AT_ONCE = 100_000  # points


@dataclass(frozen=True, eq=False)
class Actor:
    """One person: an upright capsule that stands on the ground."""

    spec: Pedestrian  # name, size and trajectory
    space: FreeSpace  # that the world leaves to people
    centre: tuple[float, float]  # around which walkers walk, the start of the rover [m]
    seed: int  # of the world
    begin: tuple[float, float] = (0.0, 0.0)  # where the walk begins [m]
    crossing: str = ""  # the first hazard that the walk leads through, and where; empty if none

    @property
    def name(self) -> str:
        """Name of the body, and of the topic before /pose."""
        return self.spec.full_name

    def walk(self) -> Walk:
        """Returns the walk from its begin on, the same each time; UsageError if there is none."""
        options, trajectory = self.spec.options, self.spec.trajectory
        if trajectory is None:
            # By the name, so that nobody's walk depends on who else walks.
            rng = generator(self.seed, PEOPLE, self.spec.name)
            way_points = RandomWalk(self.spec.name, self.space, self.centre, options, rng)
            if self.spec.walker == "social":
                return SocialForceWalker(way_points, self.space, options)
            return RandomWalker(way_points, options.speed, options.delay)
        if trajectory.times:
            return timed(
                trajectory.times,
                trajectory.points,
                loops=trajectory.loops,
                delay=trajectory.delay + options.delay,
                who=f"actor '{self.spec.name}'",
            )
        closed = options.route == "closed"
        return Route.at_speed(trajectory.points, options.speed, closed=closed, delay=options.delay)


def actor_of(spec: Pedestrian, space: FreeSpace, centre: tuple[float, float], seed: int) -> Actor:
    """Returns a person in a world; UsageError, which says where, if there is no way or no begin.

    A route may lead through hazards: people are kinematic, as Gazebo's actors are.

    Args:
        spec: Who it is.
        space: That the world leaves to people.
        centre: Around which walkers walk [m].
        seed: Of the world.
    """
    walk = Actor(spec, space, centre, seed).walk()
    points = _looked_at(walk, spec, space) if isinstance(walk, Route) else []
    if off := _first(space, points, -math.inf):
        where, (x, y) = off
        (x_min, y_min), (x_max, y_max) = space.low.tolist(), space.high.tolist()
        raise UsageError(
            f"actor '{spec.name}' walks {where} at {x:.2f},{y:.2f}; lead it around, or take another "
            f"terrain; on this one people walk at x from {x_min:g} to {x_max:g} m and y from "
            f"{y_min:g} to {y_max:g} m"
        )
    begin = walk.walk(0.0, 0.0, ()) if isinstance(walk, SocialForceWalker) else walk.place(0.0)
    crossing = ""
    if through := _first(space, points, spec.options.radius):
        where, (x, y) = through
        crossing = f"{where} at {x:.2f},{y:.2f}"
    return Actor(spec, space, centre, seed, (begin.x, begin.y), crossing)


def _looked_at(walk: Route, spec: Pedestrian, space: FreeSpace) -> list[Points]:
    """The points of a route that are looked at, in parts; of one that is too long those off the map."""
    way = spec.trajectory.points if spec.trajectory else ()
    if (length := sum(map(math.dist, way, way[1:]))) > LONGEST:
        if space.blocked(np.array(walk.points), -math.inf):
            return [np.array(walk.points)]
        said = f"actor '{spec.name}' walks {length / 1e3:.4g} km, and {LONGEST / 1e3:g} km are the most"
        raise UsageError(f"{said}; give nearer way points")
    points = along(walk.points)
    return np.array_split(points, len(points) // CHECKED_AT_ONCE + 1)


def _first(space: FreeSpace, parts: list[Points], radius: float) -> tuple[str, Points] | None:
    """What blocks a body at the first point where something does, and that point."""
    return next(filter(None, (space.blocked(part, radius) for part in parts)), None)
