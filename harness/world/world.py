"""Name + seed + difficulty -> a world: the ground and what stands on it, as plain values."""

import hashlib
from dataclasses import dataclass

import numpy as np

from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle
from harness.world.terrains import TERRAINS

DEFAULT_DIFFICULTY = 0.5
EDGE_MARGIN = 0.5  # [m] of map that must remain around the rover's origin


@dataclass(frozen=True, eq=False)
class World:
    """A ground with its obstacles, centred on the origin, where the rover starts.

    Attributes:
        notes: What was done to a heightmap file to make this of it.
    """

    name: str
    ground: Heightfield
    obstacles: tuple[Obstacle, ...]
    seed: int
    difficulty: float
    notes: tuple[str, ...] = ()


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


def terrain_hash(world: World) -> str:
    """Returns the SHA-256 of the heights and the obstacles: equal if and only if the worlds are."""
    digest = hashlib.sha256()
    digest.update(np.array(world.ground.cell, dtype="<f8").tobytes())
    digest.update(np.ascontiguousarray(world.ground.heights, dtype="<f8").tobytes())
    for obstacle in world.obstacles:
        digest.update(f"{obstacle.kind.name} {obstacle.shape}".encode())
        numbers = (*obstacle.half_size, *obstacle.position, *obstacle.quaternion)
        digest.update(np.array(numbers, dtype="<f8").tobytes())
    return digest.hexdigest()
