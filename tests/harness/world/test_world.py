from dataclasses import replace

import numpy as np
import pytest

from harness.errors import UsageError
from harness.world.heightfield import Heightfield
from harness.world.obstacles import ObstacleKind
from harness.world.world import World, build_world, starting_at, terrain_hash


def test_a_huge_seed_is_a_seed_like_any_other() -> None:
    assert build_world("rocky", 2**70).seed == 2**70


def test_a_world_knows_what_it_was_made_from() -> None:
    world = build_world("posts", 7, 0.2)
    assert (world.name, world.seed, world.difficulty) == ("posts", 7, 0.2)


def test_terrains_do_not_share_their_hills() -> None:
    rolling, rocky = (build_world(name, 1).ground.heights.ravel() for name in ("rolling", "rocky"))
    assert abs(np.corrcoef(rolling, rocky)[0, 1]) < 0.3


def _changed_worlds() -> list[World]:
    world = build_world("rocky", 0)
    lifted = world.ground.heights.copy()
    lifted[3, 5] += 1e-9
    first, *rest = world.obstacles
    moved = replace(first, position=(0.0, 0.0, 9.0))
    other_kind = {ObstacleKind.ROCK: ObstacleKind.HAZARD, ObstacleKind.HAZARD: ObstacleKind.ROCK}[
        first.kind
    ]
    return [
        replace(world, ground=Heightfield(lifted, world.ground.cell)),
        replace(world, ground=Heightfield(world.ground.heights, 0.2)),
        replace(world, obstacles=(moved, *rest)),
        replace(world, obstacles=(replace(first, kind=other_kind), *rest)),
        replace(world, obstacles=tuple(rest)),
    ]


def test_the_hash_sees_any_change_of_heights_cell_or_obstacles() -> None:
    hashes = {terrain_hash(w) for w in (build_world("rocky", 0), *_changed_worlds())}
    assert len(hashes) == 6


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
