import math
from contextlib import nullcontext
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World, build_world, check_start, starting_at, terrain_hash


def test_a_world_knows_what_it_was_made_from_and_a_huge_seed_is_one_like_any_other() -> None:
    world = build_world("posts", 2**70, 0.2)
    assert (world.name, world.seed, world.difficulty) == ("posts", 2**70, 0.2)


def test_terrains_do_not_share_their_hills() -> None:
    rolling, rocky = (build_world(name, 1).ground.heights.ravel() for name in ("rolling", "rocky"))
    assert abs(np.corrcoef(rolling, rocky)[0, 1]) < 0.3


TRIANGLE = ((0.0, 0.0, 1.0), (1.0, 0.0, -1.0), (0.0, 1.0, -1.0))
THING = Obstacle(
    *(ObstacleKind.ROCK, "surface", (0.5, 0.4, 1.0), (1.0, 2.0, 3.0), (0.6, 0.0, 0.0, 0.8)),
    *(TRIANGLE, ((0, 1, 2),)),
)
WORLD = World("w", Heightfield(np.eye(3), 0.5), (THING, THING), 0, 0.5)
OF_A_THING: dict[str, Any] = {
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
        *({"obstacles": (THING, replace(THING, **{name: OF_A_THING[name]}))} for name in OF_A_THING),
        {"obstacles": (THING,)},
        {"gravity": 3.7},
        {"friction": 0.5},
    ],
    ids=str,
)
def test_the_hash_sees_whatever_a_rover_can_feel_or_meet(change: dict[str, Any]) -> None:
    assert terrain_hash(replace(WORLD, **change)) != terrain_hash(WORLD)


def test_the_hash_sees_neither_names_nor_looks_nor_what_the_rover_does_there() -> None:
    painted = replace(THING, color=(1.0, 0.0, 0.0, 1.0))
    told: dict[str, Any] = {
        "name": "v",
        "seed": 1,
        "difficulty": None,
        "notes": ("n",),
        "files": (("f", "0"),),
    }
    driven: dict[str, Any] = {
        "start": (1.0, 2.0, 3.0),
        "room": (0.0, 1.0, 0.0, 1.0),
        "obstacles": (painted, THING),
    }
    assert terrain_hash(replace(WORLD, **told, **driven)) == terrain_hash(WORLD)


def test_a_driver_may_wander_over_the_whole_map_or_in_the_room_that_a_file_gives() -> None:
    ground = Heightfield(np.zeros((5, 9)), 0.5, (3.0, -7.0))
    world = World("oblong", ground, (), 0, None)
    assert world.roaming == ((3.0, -7.0), (2.0, 1.0))
    assert replace(world, room=(1.0, 4.0, -8.0, -6.0)).roaming == ((2.5, -7.0), (1.5, 1.0))


@pytest.mark.parametrize(
    ("start", "valid"),
    [
        ((9e9, -9e9, 6.28), True),
        ((0.0, 0.0, -6.28), True),
        ((0.0, 0.0, 6.29), False),
        ((0.0, 0.0, -90.0), False),
        ((math.inf, 0.0, 0.0), False),
        ((0.0, 0.0, math.nan), False),
        ((0.0, 0.0, 0.0, 0.0), False),
    ],
)
def test_a_start_has_three_finite_numbers_and_a_heading_of_a_turn_at_most(
    start: Any,  # noqa: ANN401 - as it is typed
    *,
    valid: bool,
) -> None:
    with nullcontext() if valid else pytest.raises(UsageError, match="is not valid; give x and y in"):
        check_start(start)


def test_the_hash_is_that_of_the_first_release() -> None:
    world = World("tiny", Heightfield(np.array([[0.0, 1.0], [2.0, 3.0]]), 0.5), (), 0, 0.5)
    assert terrain_hash(world) == ("f91cafbcc7d6b44546109777e32df9c74cf57b0efd8f96507a9350d3a630b206")


@pytest.mark.parametrize(
    ("x", "y", "valid"),
    [(4.49, -2.49, True), (-4.49, 2.49, True), (4.5, 0, False), (-4.51, 0, False), (0, 2.5, False)],
)
def test_a_start_is_on_the_map_half_a_metre_from_its_edge(x: float, y: float, *, valid: bool) -> None:
    world = World("oblong", Heightfield(np.zeros((7, 11)), 1.0), (), 0, None)
    if valid:
        assert starting_at(world, (x, y, 1.0)).start == (x, y, 1.0)
        return
    told = "off the map or at its edge; give x between -4.5 and 4.5 m, y between -2.5 and 2.5 m"
    with pytest.raises(UsageError, match=told):
        starting_at(world, (x, y, 0.0))
