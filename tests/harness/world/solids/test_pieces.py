"""Convex pieces of meshes, which are where the triangles were; primitives: their heights and places."""

import math
from collections import Counter
from typing import Any

import numpy as np
import pytest
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.base.mesh import Mesh
from harness.spec.value import made as checked_of
from harness.spec.world import WorldSpec
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, Shape, bottom, top
from harness.world.solid import Primitive, Solid
from harness.world.solids import pieces
from harness.world.solids.kinds import Kinds
from harness.world.solids.pieces import obstacle_of, obstacles_of
from tests.harness.world.solids.shapes import at, both, box

HEIGHTS = np.zeros((41, 41))
HEIGHTS[25:31, 19:22] = 2.0  # a hill around x = 0, y = 4
GROUND = Heightfield(HEIGHTS, 0.5)
CLEARANCE = 0.1


def kind_of(height: float) -> ObstacleKind:
    return ObstacleKind.ROCK if height <= CLEARANCE else ObstacleKind.HAZARD


def made(*meshes: Mesh) -> list[Obstacle]:
    return obstacles_of(both(*meshes), GROUND, kind_of, CLEARANCE)


def names(obstacles: list[Obstacle]) -> Counter[str]:
    return Counter(f"{o.kind.name} {o.shape}" for o in obstacles)


def extruded(rows: np.ndarray) -> Mesh:
    """Quads between neighbours in a grid of points, shape (rows, columns, 3)."""
    numbers = np.arange(rows.size // 3).reshape(rows.shape[:2])
    a, b, c, d = (
        n.ravel() for n in (numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:])
    )
    return Mesh(
        rows.reshape(-1, 3), np.concatenate([np.column_stack(f) for f in ((a, b, c), (a, c, d))])
    )


def tube(length: float, bend: float) -> Mesh:
    """An open pipe of 0.1 m along x that bends upwards."""
    x, angle = np.meshgrid(np.linspace(0, length, 5), np.linspace(0.0, math.tau, 13), indexing="ij")
    y, z = 0.1 * np.cos(angle), 0.5 + bend * x**2 + 0.1 * np.sin(angle)
    return both(extruded(np.stack([x, y, z], axis=-1)))


def strip(side: tuple[tuple[float, float], ...], *across: float) -> Mesh:
    """Quads from one x, z to the next, from one y to another."""
    return extruded(np.array([[(x, y, z) for y in across] for x, z in side]))


TWO_CONES = Mesh(  # upon each other, of three sides
    np.array([(0, 0, 1.2), (0, 0, 0.2), (0.3, 0, 0.7), (-0.2, 0.3, 0.7), (-0.2, -0.3, 0.7)]),
    np.array([(0, 2, 3), (0, 3, 4), (0, 4, 2), (1, 3, 2), (1, 4, 3), (1, 2, 4)]),
)


@pytest.mark.parametrize(
    ("mesh", "found"),
    [
        (box((0, 0, -0.12), (0.5, 0.5, 0.4)), {"ROCK convex": 1}),  # 8 cm above the ground
        (box((0, 0, 0.5), (0.5, 0.5, 1)), {"HAZARD convex": 1}),
        (box((0, 0, 0.5), (3, 3, 1)), {"HAZARD convex": 1}),  # nobody gets onto it
        (box((0, 0, 0.5), (3, 3, 0.05)), {"DECK convex": 1}),  # a plank to drive on
        (box((0, 0, -0.5), (3, 3, 0.992)), {}),  # flush with the ground
        (box((0, 0, -0.5), (3, 3, 1.008)), {}),
        (box((50, 0, 0.5), (1, 1, 1)), {}),  # off the map
        (strip(((-4, 0.08), (0, 2.08)), 3.9, 4.1), {"ROCK convex": 1}),  # up the hill: 8 cm above both
        (tube(2.0, 0.0), {"HAZARD convex": 1}),
        (TWO_CONES, {"HAZARD convex": 1}),
    ],
)
def test_a_convex_body_is_one_obstacle(mesh: Mesh, found: dict[str, int]) -> None:
    assert names(made(mesh)) == found


def test_a_bent_pipe_becomes_few_pieces_that_stay_near_it() -> None:
    """Every corner of a piece is one of the pipe, and pieces bulge by no more than they may."""
    mesh = tube(6.0, 0.03)
    found = made(mesh)
    assert 2 <= len(found) <= 6
    for obstacle in found:
        corners = np.array(obstacle.corners) + obstacle.position
        apart = np.linalg.norm(corners[:, None] - mesh.vertices, axis=2).min(axis=1)
        assert apart.max() < 1e-9
        middle = 0.5 * (corners[:, 0].min() + corners[:, 0].max())
        level = 0.5 + 0.03 * middle**2
        assert abs(obstacle.position[2] - level) < 0.06


def bridge() -> Mesh:
    """A body of one piece: two decks joined by a wall, a kerb, a vault and its flap."""
    side = ((-4, 0.42), (-4, 0.5), (0, 0.5), (0, 0.9), (4, 0.9))
    vault = [(1.3, 0.8), (1.0, 2.5), (0.5, 2.8), (0.0, 2.9), (-0.5, 2.8), (-1.0, 2.5), (-1.0, 0.9)]
    roof = [[(x, y, z) for y, z in vault] for x in (0.0, 4.0)]
    return both(strip(side, -1.0, 1.0), extruded(np.array(roof)))


def test_a_structure_has_decks_hazards_and_a_ceiling_that_is_only_seen() -> None:
    lower = Heightfield(HEIGHTS - 3.0, 0.5)
    found = obstacles_of(bridge().moved(at(0.0, 0.0, -3.0)), lower, kind_of, CLEARANCE)
    assert names(found) == {"DECK convex": 2, "ROCK convex": 1, "HAZARD convex": 3, "DECK surface": 1}
    decks = sorted(top(o) for o in found if o.kind is ObstacleKind.DECK and o.shape == "convex")
    assert decks == pytest.approx([-2.5, -2.1])
    (ceiling,) = (o for o in found if o.shape == "surface")
    assert (len(ceiling.faces), bottom(ceiling)) == pytest.approx((8, -0.5))


def test_a_plate_with_a_notch_is_in_pieces_that_leave_it_open() -> None:
    """An L of four triangles, 20 cm wide; each piece is a slab 2 cm deep below them."""
    corners = [(0.0, 0.0), (0.6, 0.0), (0.6, 0.2), (0.2, 0.2), (0.2, 0.6), (0.0, 0.6), (0.0, 0.2)]
    vertices = np.array([(x, y, 0.5) for x, y in corners])
    plate = Mesh(vertices, np.array([(0, 1, 2), (0, 2, 6), (6, 3, 4), (6, 4, 5)]))
    found = made(plate)
    assert len(found) > 1
    hulls = [Delaunay(np.array(one.corners) + one.position) for one in found]
    for point, is_filled in (
        *(((0.5, 0.1, 0.481), True), ((0.1, 0.5, 0.49), True), ((0.1, 0.1, 0.499), True)),
        *(((0.35, 0.35, 0.49), False), ((0.5, 0.1, 0.501), False), ((0.5, 0.1, 0.479), False)),
    ):
        assert any(hull.find_simplex(point) >= 0 for hull in hulls) is is_filled, point


def test_too_many_pieces_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces, "MOST_PIECES", 1)
    with pytest.raises(UsageError, match="more than 1 facets; simplify it first"):
        made(box((0, 0, 0.5), (1, 1, 1)), box((3, 0, 0.5), (1, 1, 1)))


SLOPE = 0.5  # along x
HILLSIDE = SLOPE * np.tile(np.arange(-20.0, 21.0), (21, 1)) * 0.5
HILLSIDE[16, 26] -= 1.0  # a hole at x = 103, y = 3
SLOPING = Heightfield(HILLSIDE, 0.5, (100.0, 0.0))
RED = (1.0, 0.0, 0.0, 1.0)


def solid(
    position: tuple[float, float, float],
    shape: Shape = "box",
    half_size: tuple[float, ...] = (0.5, 0.5, 0.2),
    turned: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Solid:
    return Solid("s", Primitive(shape, half_size), at(*position, *turned), color=RED)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("thing", "height"),
    [
        (solid((100.0, 0.0, 1.0)), 1.2 + SLOPE * 0.5),
        (solid((102.0, 0.0, 1.0)), 0.2 + SLOPE * 0.5),
        (solid((103.0, 3.0, 2.0)), 2.2 + 1.0 - SLOPE * 3.0),
        (solid((100.0, 0.0, 1.0), turned=(0.0, 0.0, math.pi / 4)), 1.2 + SLOPE * math.sqrt(0.5)),
        (solid((100.0, 0.0, 1.0), turned=(0.0, math.pi / 2, 0.0)), 1.5 + SLOPE * 0.2),
        (solid((100.0, 0.0, 1.0), "cylinder", (0.5, 0.2)), 1.2 + SLOPE * 0.5),
        (solid((100.0, 0.0, 1.0), "ellipsoid", (0.3, 0.5, 0.2)), 1.2 + SLOPE * 0.3),
        (solid((110.3, 0.0, 6.0)), 6.2 - SLOPE * 9.8),  # what is off the map has no ground
        (solid((100.0, 0.0, -0.445)), 0.005 + 1e-9),
        (solid((100.0, 0.0, -0.446)), None),  # flush with the ground
        *((solid(place), None) for place in ((100.0, 5.4, -9.0), (90.0, 5.6, 9.0))),
    ],
)
def test_its_kind_is_that_of_its_top_above_the_lowest_ground_below_it(
    thing: Solid, height: float | None
) -> None:
    asked = list[float]()

    def kind(of_top: float) -> ObstacleKind:
        asked.append(of_top)
        return ObstacleKind.ROCK

    obstacle = obstacle_of(thing, SLOPING, kind)
    if height is None:
        assert obstacle is None
        return
    assert asked == pytest.approx([height], abs=2e-6)
    assert obstacle is not None
    assert isinstance(thing.shape, Primitive)
    assert (obstacle.kind, obstacle.color) == (ObstacleKind.ROCK, RED)
    assert (obstacle.shape, obstacle.half_size) == (thing.shape.shape, thing.shape.half_size)
    assert obstacle.position == pytest.approx(thing.pose[:3, 3])
    w, x, y, z = obstacle.quaternion
    assert w >= 0.0, "of the two that mean this turn"
    assert Rotation.from_quat([x, y, z, w]).as_matrix() == pytest.approx(thing.pose[:3, :3])


SOLIDS = ("wall::link::top", "wall::link::base", "stone_1::link::c", "stone_2::link::c")


def kinds_of(**fields: Any) -> Kinds:  # noqa: ANN401 - of several fields
    return Kinds(checked_of(WorldSpec, fields), 0.125, SOLIDS)


@pytest.mark.parametrize(("rock_height", "limit"), [(None, 0.125), (0.0, 0.0), (0.5, 0.5)])
def test_what_is_no_higher_than_the_limit_is_a_rock(rock_height: float | None, limit: float) -> None:
    found = kinds_of(rock_height=rock_height)
    assert (found.limit, found.clearance) == (limit, 0.125)
    for rule in (found.by_height, found.of("wall::link::top")):
        assert [rule(height).name for height in (limit, limit + 1e-6)] == ["ROCK", "HAZARD"]


def test_names_outrule_heights_and_hazards_outrule_rocks() -> None:
    found = kinds_of(rock=("stone_?", "*::top"), hazard=("stone_2", "wall::link::base"))
    for height in (0.0, 9.0):
        assert [found.of(name)(height).name for name in SOLIDS] == ["ROCK", "HAZARD", "ROCK", "HAZARD"]
        assert found.of("sand::link::c")(height) is found.by_height(height)


def test_a_pattern_that_fits_nothing_is_refused_with_the_models_that_there_are() -> None:
    with pytest.raises(UsageError, match=r"^--rock: solid 'Stone_1' .* did you mean 'stone_1'\?$"):
        kinds_of(rock=("stone_1", "Stone_1"))
    with pytest.raises(
        UsageError, match=r"^--hazard: solid 'link' .*; available: wall, stone_1, stone_2$"
    ):
        kinds_of(hazard=("link",))
