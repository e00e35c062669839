"""Rovers in a world: who starts where, and where there is room for one more."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

from harness.robots import RoverSpec
from harness.world.occupancy import OccupancyMap, occupancy
from harness.world.world import Start, World

GAP = 0.5  # [m] between the discs that two rovers keep to
FARTHEST = 8  # places to each side

Disc = tuple[float, float, float]  # x, y, radius [m]


@dataclass(frozen=True)
class Member:
    """One of the rovers in a world; the name of a single one is empty."""

    name: str
    rover: RoverSpec
    start: Start


@lru_cache(maxsize=2)
def _ground(world: World, slope_limit: float) -> OccupancyMap:
    """The map of a world for a rover below which no rock may be, as if it could climb no step."""
    return occupancy(world, slope_limit, step_limit=0.0)


def overlaps(disc: Disc, others: Iterable[Disc], gap: float = 0.0) -> bool:
    """Returns whether a disc comes too close to one of some others.

    Args:
        disc: x, y, radius [m] in the world.
        others: x, y, radius of each [m].
        gap: The least distance between two rims [m].
    """
    x, y, radius = disc
    return any(math.hypot(x - u, y - v) < radius + other + gap for u, v, other in others)


def berth(near: Start, rover: RoverSpec, taken: Sequence[Disc], world: World) -> Start | None:
    """Returns the nearest free place beside another one, with its heading; None if there is none.

    Places lie on a square grid along that heading; of equally near ones the left is taken before the
    right, then the one behind before the one ahead. No obstacle stands there, and it is not too steep.

    Args:
        near: The other place, itself not a candidate: x, y [m], yaw [rad].
        rover: Which is to stand there.
        taken: Where others stand or will: x, y, radius [m].
        world: Ground and obstacles.
    """
    (x, y, yaw), reach = near, rover.reach
    free = _ground(world, rover.slope_limit)
    pitch = reach + max((radius for *_, radius in taken), default=reach) + GAP
    cos, sin = math.cos(yaw), math.sin(yaw)
    places = product(range(-FARTHEST, FARTHEST + 1), repeat=2)
    for ahead, left in sorted(places, key=lambda p: (math.hypot(*p), abs(p[0]), -p[1], p[0]))[1:]:
        along, across = pitch * ahead, pitch * left
        u, v = x + cos * along - sin * across, y + sin * along + cos * across
        if not overlaps((u, v, reach), taken, GAP - 1e-9) and free.is_free(u, v, reach):
            return u, v, yaw
    return None
