"""Name + seed + difficulty -> a world: the ground and what stands on it, as plain values."""

import hashlib
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from harness.errors import UsageError
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle
from harness.world.terrains import TERRAINS

if TYPE_CHECKING:
    from harness.world.actors.actor import Actor

DEFAULT_DIFFICULTY = 0.5
EDGE_MARGIN = 0.5  # [m] of map that must remain around the rover's origin

Start = tuple[float, float, float]  # x, y [m], yaw [rad] of the rover's model frame in the world


@dataclass(frozen=True, eq=False)
class World:
    """A ground with its obstacles, centred on the origin.

    Attributes:
        difficulty: None of a heightmap file, which has none.
        notes: What a heightmap file holds, and what was done to it to make this of it.
        start: Where the rover starts.
        people: Who walks about.
    """

    name: str
    ground: Heightfield
    obstacles: tuple[Obstacle, ...]
    seed: int
    difficulty: float | None
    notes: tuple[str, ...] = ()
    start: Start = (0.0, 0.0, 0.0)
    people: tuple["Actor", ...] = ()


def build_world(name: str, seed: int, difficulty: float = DEFAULT_DIFFICULTY) -> World:
    """Returns the world that these three values determine.

    Args:
        name: One of harness.world.terrains.TERRAINS.
        seed: Whole number from 0 up.
        difficulty: 0 (easiest) to 1 (hardest).
    """
    terrain = TERRAINS[name].at_difficulty(difficulty)
    # The name is in the seed, so that two terrains do not share their hills; the children are
    # independent of each other and of how much each one draws.
    ground_rng, obstacle_rng = np.random.default_rng([seed, *name.encode()]).spawn(2)
    ground = terrain.ground(ground_rng)
    obstacles = terrain.obstacles(ground, obstacle_rng)
    return World(name, ground, obstacles, seed, difficulty)


def check_start(start: Start) -> None:
    """Checks the numbers of a start by themselves.

    Raises:
        UsageError: They are none; or a heading of more than a turn, which was meant in degrees.
    """
    if len(start) != 3 or not all(map(math.isfinite, start)) or abs(start[2]) > math.tau:
        text = ",".join(f"{value:g}" for value in start)
        raise UsageError(
            f"start {text} is not valid; give x and y in metres, and yaw in radians from -6.28 to 6.28"
        )


def starting_at(world: World, start: Start) -> World:
    """Returns the same world with another start.

    Raises:
        UsageError: It is not on the map; the message tells where that is.
    """
    (x, y, _), (reach_x, reach_y) = start, (half - EDGE_MARGIN for half in world.ground.half_size)
    if not (abs(x) < reach_x and abs(y) < reach_y):
        raise UsageError(
            f"start {x:g},{y:g} is off the map or at its edge; give x between {-reach_x:g} and "
            f"{reach_x:g} m, y between {-reach_y:g} and {reach_y:g} m"
        )
    return replace(world, start=start)


def terrain_hash(world: World) -> str:
    """Returns the SHA-256 of heights, obstacles and people: equal if and only if the worlds are."""
    digest = hashlib.sha256()
    digest.update(np.array(world.ground.cell, dtype="<f8").tobytes())
    digest.update(np.ascontiguousarray(world.ground.heights, dtype="<f8").tobytes())
    for obstacle in world.obstacles:
        digest.update(f"{obstacle.kind.name} {obstacle.shape}".encode())
        numbers = (*obstacle.half_size, *obstacle.position, *obstacle.quaternion)
        digest.update(np.array(numbers, dtype="<f8").tobytes())
    for person in world.people:
        digest.update(repr((person.spec.name, person.spec.walker, person.spec.options)).encode())
        digest.update(repr(person.spec.told).encode())
    return digest.hexdigest()
