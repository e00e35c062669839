"""Worlds from SDF files and meshes, whole: ground, obstacles, start, what is noted and what refused."""

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.base.mesh import Mesh
from harness.spec.value import made
from harness.spec.world import WorldSpec
from harness.world.files import file_world
from harness.world.obstacles import ObstacleKind, top
from harness.world.solids.assembly import BUILT
from harness.world.world import ORIGIN, RoverNeeds, World
from tests.harness.world.solids.shapes import both, box, flat, sheet, write_dae, write_mesh

WORLDS = Path(__file__).parents[5] / "shared/data/roboterrain/worlds"
needs_worlds = pytest.mark.skipif(not WORLDS.is_dir(), reason=f"there is no {WORLDS}")

PLANE = "<plane><normal>0 0 1</normal><size>40 30</size></plane>"


def solid(name: str, geometry: str, pose: str = "0 0 0 0 0 0", mu: float = 1.0, looks: str = "") -> str:
    friction = f"<surface><friction><ode><mu>{mu}</mu></ode></friction></surface>"
    return (
        f"<model name='{name}'><static>1</static><pose>{pose}</pose><link name='l'>{looks}"
        f"<collision name='c'><geometry>{geometry}</geometry>{friction}</collision></link></model>"
    )


def cube(name: str, pose: str, size: str = "1 1 1") -> str:
    return solid(name, f"<box><size>{size}</size></box>", pose)


def of_file(path: Path, *, needs_start: bool = True, **fields: object) -> World:
    spec = made(WorldSpec, {"terrain": str(path)} | fields)
    return file_world(spec, RoverNeeds(needs_start=needs_start), 7)


def world_of(folder: Path, body: str, **fields: Any) -> World:  # noqa: ANN401 - of several fields
    path = folder / "a.World"
    path.write_text(f"<sdf version='1.9'><world name='w'>{body}</world></sdf>")
    return of_file(path, **fields)


def kinds(world: World) -> list[str]:
    return [obstacle.kind.name for obstacle in world.obstacles]


def test_a_ply_is_the_surface_of_its_faces_or_without_any_its_points(tmp_path: Path) -> None:
    slope = Mesh(
        np.array([[0, 0, 0], [20, 0, 2], [20, 15, 2], [0, 15, 0.0]]), np.array([[0, 1, 2], [0, 2, 3]])
    )
    of_obj, of_ply = (of_file(write_mesh(tmp_path / f"m{end}", slope)) for end in (".obj", ".ply"))
    np.testing.assert_array_equal(of_ply.ground.heights, of_obj.ground.heights)
    in_cm = write_mesh(tmp_path / "cm.obj", Mesh(150 * slope.vertices, slope.faces))
    long = of_file(in_cm, terrain_cell=10.0)
    assert [any("--mesh-unit" in note for note in world.notes) for world in (of_obj, long)] == [0, 1]
    points = [f"{x} {y} {0.1 * x}" for x in np.arange(0.0, 20.0, 0.25) for y in range(15)]
    properties = "".join(f"property float {axis}\n" for axis in "xyz")
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n{properties}end_header"
    (tmp_path / "points.ply").write_text("\n".join([head, *points, ""]))
    assert any("points become" in note for note in of_file(tmp_path / "points.ply").notes)


def test_boxes_on_a_plane_are_rocks_and_hazards_by_their_height(tmp_path: Path) -> None:
    for name in "ab":
        write_mesh(tmp_path / f"{name}.obj", box((0, 0, 0), (1, 1, 1)))
    (tmp_path / "gone.sdf").write_text(f"<sdf>{cube('gone', '3 3 -0.1 0 0 0')}</sdf>")
    red = "<visual name='v'><material><diffuse>1 0 0 1</diffuse></material></visual>"
    body = (
        "<gravity>0 0 -1.62</gravity><actor name='ann'/><actor name='ben'/><road/>"
        + solid("under it", PLANE, "1 2 0.4 0 0 0", mu=0.7)
        + solid("ground", PLANE, "1 2 0.5 0 0 0", mu=0.4)
        + cube("low", "5 0 0.1 0 0 0")
        + cube("high", "0 0 0.2 0 0 0")
        + "<include><uri>gone.sdf</uri></include>" * 2
        + cube("above", "5 0 1.5 0 0 0")
        + solid("mesh", "<mesh><uri>b.obj</uri></mesh>", "-9 0 0.5 0 0 0", mu=0.0, looks=red)
        + solid("deep", "<mesh><uri>a.obj</uri></mesh>", "0 0 -5 0 0 0")
    )
    world = world_of(tmp_path, body)
    assert kinds(world) == ["ROCK", "HAZARD", "HAZARD", "HAZARD"]
    built = [BUILT[obstacle.kind] for obstacle in world.obstacles[:3]]
    assert [obstacle.color for obstacle in world.obstacles] == [*built, (1.0, 0.0, 0.0, 1.0)]
    assert (world.gravity, world.friction, world.seed, world.difficulty) == (1.62, 0.4, 7, None)
    assert world.ground.bounds() == (-19.0, 21.0, -13.0, 17.0)
    assert np.unique(world.ground.heights).tolist() == [0.5]
    assert world.notes == (
        "left out: <road>",
        "actors: ann, ben",
        "40 m along x, 30 m along y, 401 x 301 heights 0.1 m apart, relief 0 m, middle at 1,2",
        "2 solids in the ground or off the map: left out",
        "1 rock (no higher than 0.1 m above the ground), 3 hazards, 0 facets of decks",
        "no wheel has more friction than 0.4, the lowest <mu> of its ground",
        f"starts at {world.start[0]:g},{world.start[1]:g}, the free and gentle place next to its middle",
    )
    x, y, _ = world.start
    assert 1.0 < np.hypot(x, y) < 2.5  # beside the box on 0,0
    paths = (tmp_path / name for name in ("a.World", "gone.sdf", "a.obj", "b.obj"))
    assert world.files == tuple((str(p), hashlib.sha256(p.read_bytes()).hexdigest()) for p in paths)


def test_options_override_what_is_a_rock_and_what_a_hazard(tmp_path: Path) -> None:
    """A platform above the ground and a block on it are too thick for decks, however high rocks are."""
    write_mesh(
        tmp_path / "m.obj", both(flat(), box((0, 0, 2.5), (12, 12, 1)), box((0, 0, 6), (2, 2, 1)))
    )
    body = solid("ground", PLANE) + solid("m", "<mesh><uri>m.obj</uri></mesh>")
    body += "".join(cube(name, f"{x} 0 0 0 0 0") for name, x in (("a1", 0), ("a2", 8), ("b", 11)))
    every = world_of(tmp_path, body, terrain_cell=0.5, rock_height=9.0)
    assert (kinds(every), every.start == ORIGIN) == (["ROCK"] * 5, False)
    names = {"rock": ("a?", "m"), "hazard": ("a2::l::c",)}
    named = world_of(tmp_path, body, terrain_cell=0.5, needs_start=False, **names)
    assert (kinds(named), named.start) == (["ROCK", *["HAZARD"] * 3, "ROCK"], ORIGIN)


def test_a_bridge_in_a_mesh_is_driven_on_and_under(tmp_path: Path) -> None:
    """The mesh says that y is up, which Gazebo does not read."""
    hills = sheet(lambda x, y: 0.02 * x * y, 15.0, 12.0)
    write_dae(tmp_path / "m.dae", both(hills, box((0, 0, 2.0), (6, 2, 0.08))), "<up_axis>Y_UP</up_axis>")
    mesh = "<mesh><uri>m.dae</uri><scale>1 1 1</scale></mesh>"
    world = world_of(tmp_path, solid("t", mesh, "100 50 0 0 0 0"))
    (deck,) = world.obstacles
    assert deck.kind is ObstacleKind.DECK
    assert any(note.endswith(" 0 hazards, 1 facet of decks") for note in world.notes)
    assert top(deck) == pytest.approx(2.54)
    assert world.ground.middle == pytest.approx((100.0, 50.0))
    assert world.ground.height_at(105.0, 55.0) == pytest.approx(1.0, abs=0.01)
    assert world.start == (100.0, 50.0, 0.0)
    assert [Path(name).name for name, _ in world.files] == ["a.World", "m.dae"]
    with pytest.raises(UsageError, match="it has no ground"):  # it stands on edge
        world_of(tmp_path, solid("t", mesh, "100 50 0 0 0 0"), mesh_up="y")


def test_visits_keep_to_the_largest_room_without_pits(tmp_path: Path) -> None:
    path = write_mesh(tmp_path / "t.obj", both(flat(0.0, 15.0, 10.0), flat(0.0, 6.0, 15.0)))
    world = of_file(path)
    assert world.ground.half_size == pytest.approx((15.0, 15.0), abs=0.1)
    middle, half = world.roaming
    assert middle == pytest.approx((0.0, 0.0), abs=1.0)
    assert half[0] * half[1] == pytest.approx(15.0 * 10.0, rel=0.1)


def test_models_that_stand_in_no_world_are_put_on_a_plane(tmp_path: Path) -> None:
    path = tmp_path / "loose.sdf"
    path.write_text(f"<sdf>{cube('low', '5 0 -0.45 0 0 0')}{cube('high', '0 5 0.2 0 0 0')}</sdf>")
    world = of_file(path)
    assert kinds(world) == ["ROCK", "HAZARD"]
    assert np.unique(world.ground.heights).tolist() == [0.0]
    assert any("plane" in note for note in world.notes)
    own = write_mesh(tmp_path / "t.obj", flat(0.5, 15.0, 10.0))  # brings its ground: no plane at 0
    path.write_text(
        f"<sdf>{cube('low', '5 0 0.6 0 0 0')}{solid('m', f'<mesh><uri>{own}</uri></mesh>')}</sdf>"
    )
    assert np.unique(of_file(path).ground.heights).tolist() == [0.5]


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("", "nothing in it can be collided with; give its models a <collision>"),
        ("<include><uri>https://a.b/c</uri></include>", "left out: https://a.b/c: nothing is fetched"),
        (  # what lacks the ground comes first
            "<population/>" + solid("m", "<mesh><uri>ground.dae</uri></mesh>"),
            "; left out: ground.dae: not found; name the folder that has ground.dae by .*; <population>",
        ),
        (cube("b", "0 0 0 0 0 0", "3 4 5"), "it has no ground: neither a plane nor a heightmap"),
        (solid("m", "<mesh><uri>m.obj</uri></mesh>"), r"\(the widest is 2 x 3 m\); add a ground plane"),
        (solid("m", "<mesh><uri>p.obj</uri></mesh>"), "p.obj is only Git LFS's pointer to it"),
        (solid("m", "<mesh><uri>n.obj</uri></mesh>"), "1 of its vertices are NaN or infinite"),
    ],
)
def test_worlds_that_cannot_be_driven_are_refused(tmp_path: Path, body: str, said: str) -> None:
    write_mesh(tmp_path / "m.obj", box((0, 0, 0), (2, 3, 4)))
    (tmp_path / "p.obj").write_text("version https://git-lfs.github.com/spec/v1\n")
    (tmp_path / "n.obj").write_text("v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n")
    with pytest.raises(UsageError, match=said) as raised:
        world_of(tmp_path, body)
    assert str(raised.value).count("a.World") == 1
    assert "\n" not in str(raised.value)


@needs_worlds
def test_the_inspection_world_is_met_to_a_decimetre() -> None:
    world = of_file(WORLDS / "inspection_boxes_x10_v2.world", terrain_cell=0.4)
    assert world.gravity == 9.8
    assert world.ground.bounds() == pytest.approx((-31.15, 33.28, -31.65, 67.98), abs=0.4)
    assert sum(obstacle.shape == "box" for obstacle in world.obstacles) == 17
    assert 300 < len(world.obstacles) < 700
    text = "\n".join(world.notes)
    assert "2 holes without any surface" in text
    assert float(text.split("differ from the mesh by ")[1].split()[0]) < 0.5
    (middle_x, middle_y), (half_x, half_y) = world.roaming
    assert middle_x + half_x < 31.0
    assert middle_y + half_y < 31.0
    assert min(half_x, half_y) > 28.0
