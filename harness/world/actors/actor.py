"""The people of a world: specs -> bodies with a way that is checked against ground and hazards."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.base.errors import UsageError
from harness.world.actors.people import Pedestrian
from harness.world.actors.room import Room, along
from harness.world.actors.route import Route, timed
from harness.world.actors.stroll import Stroll, StrollRoute
from harness.world.actors.walker import SocialWalker
from harness.world.world import World

RANDOM_STREAM = 20  # keeps people's generators apart from those of worlds and episodes

Way = Route | StrollRoute | SocialWalker


@dataclass(frozen=True, eq=False)
class Actor:
    """One person: an upright capsule that stands on the ground.

    Attributes:
        spec: Name, size and way.
        world: Where; without people.
        room: That it leaves to people.
        begin: Where the walk begins [m].
    """

    spec: Pedestrian
    world: World
    room: Room
    begin: tuple[float, float]

    @property
    def name(self) -> str:
        """Name of the body, and of the topic before /pose."""
        return self.spec.full_name

    def way(self) -> Way:
        """Returns the way from its begin on, the same each time."""
        return _way(self.spec, self.world, self.room)


def with_actors(world: World, specs: Sequence[Pedestrian]) -> World:
    """Returns the same world with people in it.

    Raises:
        UsageError: A way leads off the map or through a hazard, or there is no place for a walker to
            begin at; the message tells where.
    """
    room = Room(world)
    return replace(world, people=tuple(_actor(spec, world, room) for spec in specs))


def _actor(spec: Pedestrian, world: World, room: Room) -> Actor:
    way = _way(spec, world, room)
    if isinstance(way, Route) and (trouble := room.trouble(along(way.points), spec.options.radius)):
        what, (x, y) = trouble
        (x_min, y_min), (x_max, y_max) = room.low.tolist(), room.high.tolist()
        raise UsageError(
            f"actor '{spec.name}' walks {what} at {x:.2f},{y:.2f}; lead it around, or take another "
            f"terrain; on this one people walk at x from {x_min:g} to {x_max:g} m and y from "
            f"{y_min:g} to {y_max:g} m"
        )
    begin = way.walk(0.0, 0.0, ()) if isinstance(way, SocialWalker) else way.place(0.0)
    return Actor(spec, world, room, (begin.x, begin.y))


def _way(spec: Pedestrian, world: World, room: Room) -> Way:
    options = spec.options
    if spec.told is None:
        stroll = _stroll(spec, world, room)
        if spec.walker == "social":
            return SocialWalker(
                stroll, room, speed=options.speed, delay=options.delay, radius=options.radius
            )
        return StrollRoute(stroll, options.speed, options.delay)
    told = spec.told
    if told.times:
        delay = told.delay + options.delay
        return timed(told.times, told.points, loops=told.loops, delay=delay, who=f"actor '{spec.name}'")
    closed = options.route == "closed"
    return Route.at_speed(told.points, options.speed, closed=closed, delay=options.delay)


def _stroll(spec: Pedestrian, world: World, room: Room) -> Stroll:
    options = spec.options
    # By the name, so that nobody's way depends on who else walks.
    source = np.random.SeedSequence(world.seed, spawn_key=(RANDOM_STREAM, *spec.name.encode()))
    return Stroll(
        spec.name,
        room,
        world.start[:2],
        within=options.within,
        radius=options.radius,
        rng=np.random.default_rng(source),
    )
