"""Worlds as values: their hash, where a driver may wander, where a rover may start."""

from contextlib import nullcontext
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World, build_world, starting_at, terrain_hash

TRIANGLE = ((0.0, 0.0, 1.0), (1.0, 0.0, -1.0), (0.0, 1.0, -1.0))
THING = Obstacle(
    *(ObstacleKind.ROCK, "surface", (0.5, 0.4, 1.0), (1.0, 2.0, 3.0), (0.6, 0.0, 0.0, 0.8)),
    *(TRIANGLE, ((0, 1, 2),)),
)
WORLD = World("w", Heightfield(np.eye(3), 0.5), (THING, THING), 0, 0.5)
OTHER: dict[str, Any] = {
    "kind": ObstacleKind.HAZARD,
    "shape": "convex",
    "half_size": (0.5, 0.4, 1.1),
    "position": (1.0, 2.0, 3.1),
    "quaternion": (0.8, 0.0, 0.0, 0.6),
    "corners": (*TRIANGLE[:2], (0.0, 1.0, -0.9)),
    "faces": ((0, 2, 1),),
}


@pytest.mark.parametrize(
    "change",
    [
        {"ground": replace(WORLD.ground, heights=np.eye(3) * (1.0 + 1e-9))},
        {"ground": replace(WORLD.ground, cell=0.6)},
        {"ground": replace(WORLD.ground, middle=(0.0, 1.0))},
        *({"obstacles": (THING, replace(THING, **{name: OTHER[name]}))} for name in OTHER),
        *({"obstacles": (THING,)}, {"gravity": 3.7}, {"friction": 0.5}),
    ],
    ids=str,
)
def test_the_hash_sees_whatever_a_rover_can_feel_or_meet(change: dict[str, Any]) -> None:
    assert terrain_hash(replace(WORLD, **change)) != terrain_hash(WORLD)


def test_the_hash_sees_neither_names_nor_looks_nor_what_the_rover_does_there() -> None:
    """And it is that of the first release."""
    painted = (replace(THING, color=(1.0, 0.0, 0.0, 1.0)), THING)
    named = replace(WORLD, name="v", seed=1, difficulty=None, notes=("n",), files=(("f", "0"),))
    driven = replace(named, start=(1.0, 2.0, 3.0), room=(0.0, 1.0, 0.0, 1.0), obstacles=painted)
    assert terrain_hash(driven) == terrain_hash(WORLD)
    tiny = World("tiny", Heightfield(np.array([[0.0, 1.0], [2.0, 3.0]]), 0.5), (), 0, 0.5)
    assert terrain_hash(tiny) == "f91cafbcc7d6b44546109777e32df9c74cf57b0efd8f96507a9350d3a630b206"


def test_a_world_knows_what_it_was_made_from_and_terrains_do_not_share_their_hills() -> None:
    world = build_world("posts", 2**70, 0.2)  # a huge seed is one like any other
    assert (world.name, world.seed, world.difficulty) == ("posts", 2**70, 0.2)
    rolling, rocky = (build_world(name, 1).ground.heights.ravel() for name in ("rolling", "rocky"))
    assert abs(np.corrcoef(rolling, rocky)[0, 1]) < 0.3


def test_a_driver_may_wander_over_the_whole_map_or_in_the_room_that_a_file_gives() -> None:
    world = World("oblong", Heightfield(np.zeros((5, 9)), 0.5, (3.0, -7.0)), (), 0, None)
    assert world.roaming == ((3.0, -7.0), (2.0, 1.0))
    assert replace(world, room=(1.0, 4.0, -8.0, -6.0)).roaming == ((2.5, -7.0), (1.5, 1.0))


@pytest.mark.parametrize(
    ("x", "y", "valid"),
    [(4.49, -2.49, True), (-4.49, 2.49, True), (4.5, 0, False), (-4.51, 0, False), (0, 2.5, False)],
)
def test_a_start_is_on_the_map_half_a_metre_from_its_edge(x: float, y: float, *, valid: bool) -> None:
    world = World("oblong", Heightfield(np.zeros((7, 11)), 1.0), (), 0, None)
    said = "give x between -4.5 and 4.5 m, y between -2.5 and 2.5 m"
    with nullcontext() if valid else pytest.raises(UsageError, match=said):
        assert starting_at(world, (x, y, 1.0)).start == (x, y, 1.0)
