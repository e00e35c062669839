"""Files with people, and what strangers put into them."""

from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.world.actors.trajectory import read_told

DATA = Path(__file__).parents[5] / "shared/data/roboterrain/trajectories"
POINT = "<waypoint><time>{}</time><pose>{} 0 0 0</pose></waypoint>"
LINE = POINT.format(1.5, "1 2 3") + POINT.format(4.0, "4 5 6")


def written(folder: Path, text: str, name: str = "inspect_diag.sdf") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.skipif(not DATA.is_dir(), reason="needs the RoboTerrain trajectories in ../shared/data")
@pytest.mark.parametrize(
    ("file", "name", "first"),
    [
        ("flat_triangle_traject.sdf", "triangle", (-2.0, 2.0, 0.5)),
        ("inspect_diag.sdf", "diag", (-13.531637612227838, -23.40254360254535, 4.874879211069552)),
    ],
)
def test_roboterrains_files_are_read(file: str, name: str, first: tuple[float, ...]) -> None:
    (told,) = read_told(DATA / file)
    assert (told.name, told.points[0], told.times) == (name, first, ())
    assert len(told.points) == (DATA / file).read_text().count("<waypoint>")


@pytest.mark.parametrize(
    ("stem", "name"),
    [
        ("inspect_linear", "linear"),
        ("island_triangle2_traject", "triangle2"),
        ("my_walk", "my_walk"),
        ("moon_a_trajectory", "a"),
        ("construct_flat_b_traject_2", "flat_b_2"),
        ("my_trajectories", "my_trajectories"),
    ],
)
def test_a_trajectory_is_called_as_its_topic(stem: str, name: str, tmp_path: Path) -> None:
    (told,) = read_told(written(tmp_path, f"<trajectory>{LINE}</trajectory>", f"{stem}.sdf"))
    assert (told.name, told.points) == (name, ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0)))


def test_the_actors_of_a_world_have_their_names_poses_and_times(tmp_path: Path) -> None:
    script = (
        f"<script><loop>false</loop><delay_start>2</delay_start><trajectory>{LINE}</trajectory></script>"
    )
    actors = f"<actor name='a'><pose>10 0 0 0 0 1.5707963267948966</pose>{script}</actor>"
    stands = "<actor name='b'><pose>7 8 9 0 0 0</pose></actor>"
    point = "<waypoint><pose>1 2 3 0 0 0</pose></waypoint>"
    bare = f"<actor name='c'><script><trajectory>{point}</trajectory></script></actor>"
    a, b, c = read_told(written(tmp_path, f"<sdf><world><model/>{actors}{stands}{bare}</world></sdf>"))
    assert (a.name, a.times, a.loops, a.delay) == ("a", (1.5, 4.0), False, 2.0)
    assert np.array(a.points) == pytest.approx(np.array([[8.0, 1.0, 3.0], [5.0, 4.0, 6.0]]))
    assert (b.name, b.points, b.times, b.loops) == ("b", ((7.0, 8.0, 9.0),), (0.0,), True)
    assert (c.points, c.times, c.loops, c.delay) == (((1.0, 2.0, 3.0),), (0.0,), True, 0.0)


def test_an_actor_without_a_name_is_called_actor(tmp_path: Path) -> None:
    (told,) = read_told(written(tmp_path, "<actor><pose>1 2 3 0 0 0</pose></actor>"))
    assert (told.name, told.points) == ("actor", ((1.0, 2.0, 3.0),))


LAUGHS = '<!DOCTYPE t [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]><trajectory>&b;</trajectory>'


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (LAUGHS, "declares a document type or entities"),
        ("<trajectory>", "it is not XML"),
        ("<sdf><world/></sdf>", "neither a <trajectory> nor an <actor>"),
        ("<trajectory/>", "0 way points; give 1 to"),
        ("<trajectory><waypoint/></trajectory>", "way point '' is not valid; give 6"),
        (
            f"<trajectory>{POINT.format(0, '1 nan 3')}</trajectory>",
            "'1 nan 3 0 0 0' is not valid; give 6",
        ),
        (f"<trajectory>{POINT.format('x', '1 2 3')}</trajectory>", "'x' is not valid; give 1 finite"),
        (f"<trajectory>{POINT.format(0, '1 2')}</trajectory>", "give 6 finite"),
    ],
)
def test_what_is_no_way_is_refused_in_one_line(text: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=told):
        read_told(written(tmp_path, text))
