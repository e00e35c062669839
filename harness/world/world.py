"""Name + seed + difficulty -> a world: the ground and what stands on it, as plain values."""

import hashlib
import math
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from harness.base.errors import UsageError
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
    """A ground with its obstacles.

    Attributes:
        difficulty: None of a file, which has none.
        notes: What a file holds, and what was done to it to make this of it.
        start: Where the rover starts.
        room: Where a driver may wander: x from, x to, y from, y to [m]; None is the whole map.
        gravity: Downwards [m/s^2]; None is that of the rover's model.
        friction: Of the ground where it is less than the wheels' own; None is theirs.
        files: Those that it was read from, each with its SHA-256.
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
    room: tuple[float, float, float, float] | None = None
    gravity: float | None = None
    friction: float | None = None
    files: tuple[tuple[str, str], ...] = ()

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
    if not world.ground.contains(*start[:2], EDGE_MARGIN):
        x, x_to, y, y_to = world.ground.bounds(EDGE_MARGIN)
        raise UsageError(
            f"start {start[0]:g},{start[1]:g} is off the map or at its edge; give x between {x:g} and "
            f"{x_to:g} m, y between {y:g} and {y_to:g} m"
        )
    return replace(world, start=start)


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
    if (physical := (*world.ground.middle, world.gravity, world.friction)) != (0.0, 0.0, None, None):
        digest.update(repr(physical).encode())
    for person in world.people:
        digest.update(repr((person.spec.name, person.spec.walker, person.spec.options)).encode())
        digest.update(repr(person.spec.told).encode())
    return digest.hexdigest()
