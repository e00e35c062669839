"""The people of a world: bodies whose walks are checked against ground and hazards."""

from dataclasses import dataclass

from harness.base.errors import UsageError
from harness.base.streams import PEOPLE, generator
from harness.world.actors.free_space import FreeSpace, along
from harness.world.actors.people import Pedestrian
from harness.world.actors.random_walk import RandomWalk, RandomWalker
from harness.world.actors.route import Route, timed
from harness.world.actors.social_force import SocialForceWalker

Walk = Route | RandomWalker | SocialForceWalker


@dataclass(frozen=True, eq=False)
class Actor:
    """One person: an upright capsule that stands on the ground."""

    spec: Pedestrian  # name, size and trajectory
    space: FreeSpace  # that the world leaves to people
    centre: tuple[float, float]  # around which walkers walk, the start of the rover [m]
    seed: int  # of the world
    begin: tuple[float, float] = (0.0, 0.0)  # where the walk begins [m]

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

    Args:
        spec: Who it is.
        space: That the world leaves to people.
        centre: Around which walkers walk [m].
        seed: Of the world.
    """
    walk = Actor(spec, space, centre, seed).walk()
    if isinstance(walk, Route) and (hit := space.blocked(along(walk.points), spec.options.radius)):
        where, (x, y) = hit
        (x_min, y_min), (x_max, y_max) = space.low.tolist(), space.high.tolist()
        raise UsageError(
            f"actor '{spec.name}' walks {where} at {x:.2f},{y:.2f}; lead it around, or take another "
            f"terrain; on this one people walk at x from {x_min:g} to {x_max:g} m and y from "
            f"{y_min:g} to {y_max:g} m"
        )
    begin = walk.walk(0.0, 0.0, ()) if isinstance(walk, SocialForceWalker) else walk.place(0.0)
    return Actor(spec, space, centre, seed, (begin.x, begin.y))
