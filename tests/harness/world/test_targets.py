"""Targets: markers against OpenCV, places against geodesy, bodies and skins against the request."""

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
from PIL import Image

from harness.base.errors import UsageError
from harness.episode.assembly import check, scenery, world_of
from harness.physics.scene import build_scenes
from harness.spec.run import Run
from harness.spec.target import DICTIONARIES, parse_target
from harness.world.actors.free_space import FreeSpace
from harness.world.obstacles import bottom, top
from harness.world.targets.forms import cells, face_image
from harness.world.targets.placing import Target
from harness.world.world import terrain_hash


def targets(*texts: str, **changes: object) -> tuple[Target, ...]:
    return world_of(Run.of(targets=texts, **{"terrain": "rocky", "seed": 3} | changes)).targets


@pytest.mark.parametrize("dictionary", DICTIONARIES)
def test_markers_are_those_of_opencv(dictionary: str) -> None:
    aruco = pytest.importorskip("cv2", reason="OpenCV is not installed").aruco
    name = dictionary.upper().replace("APRILTAG_36H11", "APRILTAG_36h11")
    known = aruco.getPredefinedDictionary(
        getattr(aruco, f"DICT_{'ARUCO_ORIGINAL' if name == 'ORIGINAL' else name}")
    )
    count, n = DICTIONARIES[dictionary]
    for marker in (0, 1, 17, count // 2, count - 1):
        drawn = aruco.generateImageMarker(known, marker, n + 2)
        np.testing.assert_array_equal(cells(dictionary, marker), drawn > 0)
    assert face_image(dictionary, 1)[0].all()  # the margin is white


def test_a_face_of_20_cm_carries_a_black_square_of_15_cm_at_its_height() -> None:
    (post,) = targets("aruco:x=3,y=1,height=0.7")
    assert len(post.skins) == 3
    for skin in post.skins:
        assert np.linalg.norm(skin.vertices[1] - skin.vertices[0]) == pytest.approx(0.2)
        assert skin.vertices[:, 2].mean() == pytest.approx(post.position[2] + 0.7)
    towards_start = post.skins[0].vertices.mean(axis=0)[:2] - post.position[:2]
    assert towards_start @ (-3.0, -1.0) > 0.0
    black = (face_image("4x4_50", 0)[..., 0] == 0).any(axis=0)
    assert black.mean() * 0.2 == pytest.approx(0.15)


@pytest.mark.parametrize(
    "text", ["aruco", "aruco:faces=1", "aruco:faces=4", "gate", "post", "mallet", "bottle"]
)
def test_every_kind_stands_on_the_ground_at_a_free_place_that_its_seed_draws(text: str) -> None:
    (target,), (again,) = targets(text), targets(text)
    (other,) = targets(text, seed=4)
    assert target.position == again.position != other.position
    assert 2.0 <= math.hypot(*target.position[:2]) <= 8.0
    world = world_of(Run.of(terrain="rocky", seed=3))
    space = FreeSpace(world.ground, world.obstacles)
    assert space.blocked(np.array(target.posts), 0.5) is None
    lowest, highest = min(map(bottom, target.bodies)), max(map(top, target.bodies))
    heights = [world.ground.height_at(*post) for post in target.posts]
    assert lowest <= min(heights) + 1e-9
    assert max(heights) < highest


def test_a_place_in_degrees_is_that_in_metres() -> None:
    from pymap3d import enu2geodetic  # noqa: PLC0415 - another way round than the world's

    lat, lon, _ = enu2geodetic(5.0, -3.0, 0.0, 38.0, -110.0, 100.0)
    (target,) = targets(f"post:lat={lat},lon={lon}", datum="38,-110,100")
    assert target.position[:2] == pytest.approx((5.0, -3.0), abs=1e-5)


def test_a_gates_posts_stand_apart_across_the_way_from_the_start() -> None:
    (gate,) = targets("gate:x=6,y=0,width=3,id=4", terrain="flat")
    assert np.array(gate.posts) == pytest.approx(np.array([(6.0, 1.5), (6.0, -1.5)]))
    left = gate.skins[0].image
    np.testing.assert_array_equal(left, face_image("4x4_50", 4))
    np.testing.assert_array_equal(gate.skins[3].image, face_image("4x4_50", 5))


def test_markers_change_a_worlds_hash_and_no_other_world() -> None:
    plain = terrain_hash(world_of(Run.of(terrain="rocky", seed=3)))
    hashes = {
        terrain_hash(world_of(Run.of(terrain="rocky", seed=3, targets=[f"aruco:x=3,y=0,id={number}"])))
        for number in (1, 2)
    }
    assert len({plain, *hashes}) == 3


def test_a_mesh_that_lies_elsewhere_is_that_of_its_text() -> None:
    text = "b={}.obj:x=1,y=2,texture={}.png"
    moved = parse_target(text.format("a", "c")).in_file("in/a.obj", "in/c.png")
    assert moved == parse_target(text.format("in/a", "in/c"))
    assert moved.files == ("in/a.obj", "in/c.png")


def test_a_mesh_is_met_as_its_bodies_and_seen_with_its_picture(tmp_path: Path) -> None:
    (tmp_path / "cube.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"
        "f 1/1 3/3 2/2\nf 1/1 2/2 4/4\nf 2/2 3/3 4/4\nf 3/3 1/1 4/4\n"
    )
    Image.new("RGB", (8, 4), (0, 255, 0)).save(tmp_path / "green.png")
    text = f"{tmp_path / 'cube.obj'}:scale=0.5,x=3,y=1,yaw=0,texture={tmp_path / 'green.png'}"
    run = Run.of(terrain="flat", targets=[text])
    world, members = scenery(run)
    (target,) = world.targets
    assert target.skins[0].image.shape == (4, 8, 3)
    assert [Path(name).name for name, _ in target.files] == ["cube.obj", "green.png"]
    seen = build_scenes(world, members, 0.002, lambda _: None)[0].model
    met = build_scenes(world, members, 0.002)[0].model
    assert (seen.nmesh - met.nmesh, met.ntex, seen.ntex) == (1, 0, 1)
    geom, data = np.zeros(1, np.int32), mujoco.MjData(met)
    mujoco.mj_forward(met, data)
    distance = mujoco.mj_ray(met, data, (3.1, 1.1, 3.0), (0.0, 0.0, -1.0), None, 1, -1, geom, None)
    assert 2.5 <= distance < 2.9


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (["flag"], "available: aruco"),
        (["aruco:idd=3"], "did you mean 'id'"),
        (["aruco:id=50"], "0 to 49"),
        (["gate:id=49"], "two ids"),
        (["aruco:x=1"], "x and y"),
        (["aruco:x=1,y=1,lat=3,lon=3"], "not as both"),
        (["post:dictionary=4x4_50"], "height, radius"),
        (["post:x=500,y=0"], "x between"),
        (["aruco:x=nan,y=0"], "finite"),
        (["1a=post"], "letters"),
        (["a=post", "a=gate"], "name of its own"),
        (["missing.obj"], "cannot read"),
        (["post"] * 101, "at most 100"),
        (["post:within=3"] * 20, "no free place"),
        ([""], "give [NAME=]KIND"),
    ],
)
def test_what_is_wrong_is_told_in_one_line_with_what_is_right(texts: list[str], words: str) -> None:
    def asked() -> None:
        run = Run.of(terrain="flat", targets=texts)
        check(run)
        world_of(run)

    with pytest.raises(UsageError) as told:
        asked()
    assert words in str(told.value)
    assert "\n" not in str(told.value)
