"""Who walks: texts of --actor, trajectories and SDF files, and what strangers put into them."""

import re
from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.episode.assembly import actor_names, people
from harness.spec.actor import ActorOptions, parse_actor
from harness.spec.run import Run
from harness.world.actors.people import Trajectory, of_terrain, read_trajectories
from tests.support.words import parse_actors

FILES = "people.sdf", "anna=people.sdf", "anna=people.sdf:speed=2,radius=0.3", "people.sdf:delay=3"
POINT = "<waypoint><time>{}</time><pose>{} 0 0 0</pose></waypoint>"
LINE = POINT.format(1.5, "1 2 3") + POINT.format(4.0, "4 5 6")
WAY = ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))


@pytest.mark.parametrize("text", FILES)
def test_people_of_a_file_that_lies_elsewhere_are_those_of_its_text(text: str) -> None:
    elsewhere = text.replace("people.sdf", "there/p.sdf")
    assert parse_actor(text).in_file("there/p.sdf") == parse_actor(elsewhere)


def written(folder: Path, text: str, name: str = "inspect_diag.sdf") -> Path:
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "name", "walker", "points", "options"),
    [
        ("g=1,-2/.5,3e0", "g", "", ((1.0, -2.0), (0.5, 3.0)), {}),
        ("factor=+1.,-2e-1", "factor", "", ((1.0, -0.2),), {}),
        ("g_actor=1,2:route=closed,push=1", "g", "", ((1.0, 2.0),), {"route": "closed", "push": 1}),
        ("random", "random", "random", None, {}),
        ("Bo=random:speed=2,speed=3", "Bo", "random", None, {"speed": 3.0}),
        ("me_2=social:within=4,radius=.2", "me_2", "social", None, {"within": 4, "radius": 0.2}),
    ],
)
def test_a_text_says_who_walks_and_how(
    text: str, name: str, walker: str, points: object, options: dict[str, object]
) -> None:
    (person,) = parse_actors([text])
    assert (person.name, person.full_name, person.walker) == (name, f"{name}_actor", walker)
    assert (person.trajectory and person.trajectory.points) == points
    assert person.options == ActorOptions.model_validate(options)


def test_a_trajectory_is_called_as_its_topic(tmp_path: Path) -> None:
    for stem, name in (
        *(
            ("inspect_linear", "linear"),
            ("island_triangle2_traject", "triangle2"),
            ("my_walk", "my_walk"),
        ),
        *(("moon_a_trajectory", "a"), ("construct_flat_b_traject_2", "flat_b_2")),
        ("my_trajectories", "my_trajectories"),
    ):
        path = written(tmp_path, f"<trajectory>{LINE}</trajectory>", f"{stem}.sdf")
        assert read_trajectories(path) == (Trajectory(name, WAY),)


def test_the_actors_of_a_world_have_their_names_poses_and_times(tmp_path: Path) -> None:
    script = (
        f"<script><loop>false</loop><delay_start>2</delay_start><trajectory>{LINE}</trajectory></script>"
    )
    actors = (
        f"<actor name='a'><pose>10 0 0 0 0 1.5707963267948966</pose>{script}</actor>"
        "<actor name='b'><pose>7 8 9 0 0 0</pose></actor>"
        "<actor name='c'><script><waypoint><pose>1 2 3 0 0 0</pose></waypoint></script></actor>"
    )
    a, b, c = read_trajectories(written(tmp_path, f"<sdf><world><model/>{actors}</world></sdf>"))
    assert (a.name, a.times, a.loops, a.delay) == ("a", (1.5, 4.0), False, 2.0)
    np.testing.assert_allclose(a.points, [[8.0, 1.0, 3.0], [5.0, 4.0, 6.0]])
    assert b == Trajectory("b", ((7.0, 8.0, 9.0),), (0.0,))
    assert c == Trajectory("c", (WAY[0],), (0.0,), loops=True, delay=0.0)
    (alone,) = read_trajectories(written(tmp_path, "<actor><pose>1 2 3 0 0 0</pose></actor>", "b.sdf"))
    assert alone == Trajectory("actor", (WAY[0],), (0.0,))


def test_a_file_names_its_people_unless_the_text_does(tmp_path: Path) -> None:
    one = written(tmp_path, f"<trajectory>{LINE}</trajectory>")
    two = written(tmp_path, "<sdf><actor name='a_actor'/><actor name='b'/></sdf>", "Two.WORLD")
    found = parse_actors([str(one), f"g={one}:speed=2", str(two)])
    assert [p.full_name for p in found] == ["diag_actor", "g_actor", "a_actor", "b_actor"]
    named = "".join(
        f"<actor name='{name}'/>"
        for name in ("c d", "Jürgen", "9", "人", "行人2", "行人", "c_d_2", "e_actor")
    )
    written(tmp_path, f"<sdf>{named}</sdf>")  # read anew, as it has changed
    names = ["c_d", "Jurgen", "person_9", "person", "person_2", "person_3", "c_d_2", "e"]
    assert [person.name for person in parse_actors([str(one)])] == names


def test_the_people_of_a_terrain_are_the_actors_of_its_file_and_of_what_it_includes(
    tmp_path: Path,
) -> None:
    script = f"<script><trajectory>{LINE}</trajectory></script>"
    written(tmp_path, f"<sdf><actor name='v'>{script}</actor></sdf>", "models/v.sdf")
    include = "<include><uri>v.sdf</uri><pose>7 0 0 0 0 1.5707963267948966</pose></include>"
    text = f"<sdf><world><actor name='a'/>{include}</world></sdf>".replace(">", ">\r\n")
    world = tmp_path / "a.WORLD"
    run = Run.of(terrain=str(world), resource_path=(str(tmp_path / "models"),), actors=("b=1,2",))
    for encoding in ("utf-8", "utf-16"):
        world.write_bytes(text.encode(encoding))
        assert actor_names(run.world) == ("a_actor", "v_actor", "b_actor")
        walk = people(run.world)[1].trajectory
        assert walk is not None
        assert walk.points[0] == pytest.approx((5.0, 1.0, 3.0))
    empty, broken = (
        written(tmp_path, f"<sdf>{end}", f"{len(end)}.sdf") for end in ("<world/></sdf>", "")
    )
    nobodys = ("rocky", str(empty), str(broken), str(tmp_path / "c.sdf"))  # the world reports mistakes
    assert [of_terrain(name) for name in nobodys] == [()] * 4


BAD_FILES = [
    ("<trajectory>", "it is not XML"),
    ("<sdf><world/></sdf>", "neither a <trajectory> nor an <actor>"),
    ("<trajectory/>", "0 way points; give 1 to"),
    ("<trajectory><waypoint/></trajectory>", "way point '' is not valid; give 6"),
    (f"<trajectory>{POINT.format('x', '1 2 3')}</trajectory>", "'x' is not valid; give 1 finite"),
    (f"<trajectory>{POINT.format(0, '1 2')}</trajectory>", "give 6 finite"),
    ("<sdf><actor name='a'><script/></actor></sdf>", "0 way points"),
    ("<sdf><actor name='a'/><actor name='b'/></sdf>", "has 2 actors with names; leave out 'g='"),
]
BAD_TEXTS = [
    *(
        ("walker", "give [NAME=]FILE"),
        ("g=1,2/x", "is not valid; give"),
        ("1,2/3,4", "has no name; give"),
    ),
    *(("9=random", "is not valid; give"), ("g=none.sdf", "cannot read none.sdf: ")),
    *(("g=random:speed=1=2", "speed '1=2'"), ("g=random:delay=", "delay ''")),
    ("g=1,2:spead=1", "key 'spead' does not exist; did you mean 'speed'"),
    *(("g=1,2:route=round", "'mirror' or 'closed'"), ("g=random:push=0.5", "push '0.5'")),
    *((f"g=random:radius=0.5,height={height}", "higher than wide") for height in (0.8, 1)),
]


@pytest.mark.parametrize(("text", "said"), BAD_FILES + BAD_TEXTS)
def test_mistakes_are_one_line_that_names_what_is_valid(text: str, said: str, tmp_path: Path) -> None:
    is_file = text.startswith("<")
    path = written(tmp_path, text) if is_file else None
    with pytest.raises(UsageError, match=re.escape(said)) as raised:
        parse_actors([f"g={path}" if "leave out" in said else str(path)] if is_file else [text])
    assert "\n" not in str(raised.value)


def test_names_are_different_and_people_not_too_many() -> None:
    with pytest.raises(UsageError, match="two actors are called 'g'; give one another name"):
        parse_actors(["g=1,2", "g_actor=random"])
    assert len(parse_actors(["g=1,2", "G=1,2"])) == 2
    with pytest.raises(UsageError, match="101 actors are too many; give at most 100"):
        parse_actors([f"p{n}=random" for n in range(101)])
    assert len(parse_actors([f"p{n}=random" for n in range(100)])) == 100
