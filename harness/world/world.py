"""Name + seed + difficulty -> a world: the ground and what stands on it, as plain values."""

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

import numpy as np

from harness.spec.target import TargetSpec
from harness.spec.world import DEFAULT_DIFFICULTY
from harness.world.actors.actor import Actor, actor_of
from harness.world.actors.free_space import FreeSpace
from harness.world.actors.people import Pedestrian
from harness.world.geodesy import Datum
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle
from harness.world.soil_map import Soils
from harness.world.targets.placing import Target, placed_targets
from harness.world.terrains import TERRAINS
from rover_metrics.plugins import misfit

Start = tuple[float, float, float]  # x, y [m], yaw [rad] of the rover's model frame in the world

ORIGIN: Start = (0.0, 0.0, 0.0)
STEEPEST_START = 15.0  # [deg] around the start of a world from a file


@dataclass(frozen=True)
class RoverNeeds:
    """What a world from a file has to know of the rover that drives in it."""

    clearance: float = 0.1  # height of obstacles that the rover drives over [m]
    step_limit: float = 0.07  # highest step that the rover climbs [m]
    wheel_radius: float = 0.0  # [m]; 0 if it does not matter
    needs_start: bool = True  # whether a place to start from is to be looked for


@dataclass(frozen=True, eq=False)
class World:
    """A ground with its obstacles."""

    name: str
    ground: Heightfield
    obstacles: tuple[Obstacle, ...]
    seed: int
    difficulty: float | None  # from 0 to 1; None if the world comes from a file
    notes: tuple[str, ...] = ()  # what a file holds, and what was done to make a world of it
    start: Start = ORIGIN  # where the rover starts
    people: tuple[Actor, ...] = ()  # who walks about
    targets: tuple[Target, ...] = ()  # what is to be found; their bodies are among the obstacles
    # where a driver may wander: x from, x to, y from, y to [m]; None is the whole map
    room: tuple[float, float, float, float] | None = None
    gravity: float | None = None  # downwards [m/s^2]; None is that of the rover's model
    friction: float | None = None  # of the ground where it is less than the wheels' own; None is theirs
    soil: Soils | None = None  # what the ground is of; None is rigid
    files: tuple[tuple[str, str], ...] = ()  # those that the world was read from, each with its SHA-256

    @property
    def roaming(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Middle and half lengths along x and y of where a driver may wander [m]."""
        if self.room is None:
            return self.ground.middle, self.ground.half_size
        x, x_to, y, y_to = self.room
        return (0.5 * (x + x_to), 0.5 * (y + y_to)), (0.5 * (x_to - x), 0.5 * (y_to - y))


def build_world(name: str, seed: int, difficulty: float = DEFAULT_DIFFICULTY) -> World:
    """Returns the world that these three values determine.

    Args:
        name: Of harness.world.terrains.TERRAINS, or FILE.py:CLASS.
        seed: 0 or more.
        difficulty: 0 (easiest) to 1 (hardest).
    """
    kind = TERRAINS[name]
    terrain, name = kind.at_difficulty(difficulty), kind.name
    # The name is in the seed, so that two terrains do not share their hills; the children are
    # independent of each other and of how much each one draws.
    ground_rng, obstacle_rng = np.random.default_rng([seed, *name.encode()]).spawn(2)
    ground = terrain.ground(ground_rng)
    given: Any = terrain.obstacles(ground, obstacle_rng)
    obstacles = tuple(given) if isinstance(given, Iterable) else ()
    if not (isinstance(given, Iterable) and all(isinstance(one, Obstacle) for one in obstacles)):
        raise misfit(kind, given, "Obstacles")
    return World(name, ground, obstacles, seed, difficulty)


def starting_at(world: World, start: Start) -> World:
    """Returns the same world with another start; UsageError, which tells the map, if it is off it."""
    world.ground.check_place("start", *start[:2])
    return replace(world, start=start)


def with_actors(world: World, people: Sequence[Pedestrian]) -> World:
    """Returns the same world with people in it; UsageError where one of them cannot walk."""
    space = FreeSpace(world.ground, world.obstacles)
    actors = tuple(actor_of(one, space, world.start[:2], world.seed) for one in people)
    notes = (f"actor '{a.spec.name}' walks {a.crossing}, as Gazebo's do" for a in actors if a.crossing)
    return replace(world, people=actors, notes=(*world.notes, *notes))


def with_targets(world: World, specs: Sequence[TargetSpec], datum: Datum) -> World:
    """Returns the same world with targets in it.

    Args:
        world: Has none yet.
        specs: What stands where.
        datum: The world's origin on the Earth.

    Raises:
        UsageError: One cannot stand there.
    """
    start = world.start[:2]
    targets = placed_targets(specs, world.ground, world.obstacles, start, world.seed, datum)
    bodies = tuple(body for target in targets for body in target.bodies)
    files = tuple(file for target in targets for file in target.files)
    return replace(
        world,
        targets=targets,
        obstacles=(*world.obstacles, *bodies),
        files=tuple(dict.fromkeys((*world.files, *files))),
    )


def terrain_hash(world: World) -> str:
    """Returns the SHA-256 of all that a rover can feel or meet: equal if and only if the worlds are."""
    digest = hashlib.sha256()
    digest.update(np.array(world.ground.cell, dtype="<f8").tobytes())
    digest.update(np.ascontiguousarray(world.ground.heights, dtype="<f8").tobytes())
    for obstacle in world.obstacles:
        digest.update(f"{obstacle.kind.name} {obstacle.shape}".encode())
        numbers = (*obstacle.half_size, *obstacle.position, *obstacle.quaternion)
        digest.update(
            np.array([*numbers, *chain(*obstacle.corners, *obstacle.faces)], dtype="<f8").tobytes()
        )
    if world.soil is not None:
        for soil in world.soil.kinds:
            digest.update(soil.model_dump_json().encode())
        if len(world.soil.kinds) > 1:
            digest.update(world.soil.patches.tobytes())
    if (physical := (*world.ground.middle, world.gravity, world.friction)) != (0.0, 0.0, None, None):
        digest.update(repr(physical).encode())
    for target in world.targets:
        digest.update(target.digest())
    for person in world.people:
        spec = person.spec
        options = dict(spec.options) | {"push": float(spec.options.push) or 0}
        digest.update(f"({spec.name!r}, {spec.walker!r}, {_named('Options', options)})".encode())
        way = spec.trajectory
        digest.update((repr(way) if way is None else _named("Told", vars(way))).encode())
    return digest.hexdigest()


def _named(name: str, values: Mapping[str, object]) -> str:
    """Values as the first release wrote them, so that the hash of a world with people stays."""
    return f"{name}({', '.join(f'{key}={value!r}' for key, value in values.items())})"
