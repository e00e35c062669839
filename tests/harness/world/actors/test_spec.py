"""`--actor` as text."""

import re
from pathlib import Path
from typing import Any

import pytest
from harness.world.actors.spec import Options, beside, of_terrain, parse_actors

from harness.base.errors import UsageError
from harness.spec.run import Run


def actor_names(texts: list[str]) -> tuple[str, ...]:
    return Run.of(actors=tuple(texts)).actor_names()


DEFAULTS: dict[str, Any] = {"speed": 1.0, "route": "mirror", "delay": 0.0, "within": 8.0, "push": 0}
DEFAULTS |= {"radius": 0.25, "height": 1.75}
LINE = "<waypoint><time>0</time><pose>1 2 3 0 0 0</pose></waypoint>"


@pytest.mark.parametrize(
    ("text", "name", "walker", "points", "options"),
    [
        ("g=1,-2/.5,3e0", "g", "", ((1.0, -2.0), (0.5, 3.0)), Options(**DEFAULTS)),
        ("factor=+1.,-2e-1", "factor", "", ((1.0, -0.2),), Options()),
        ("my_actor_2=1,2", "my_actor_2", "", ((1.0, 2.0),), Options()),
        ("g_actor=1,2:route=closed,push=1", "g", "", ((1.0, 2.0),), Options(route="closed", push=1)),
        ("random", "random", "random", None, Options()),
        ("Bo=random:speed=2,speed=3", "Bo", "random", None, Options(speed=3.0)),
        ("me=social:speed=1.5,delay=2", "me", "social", None, Options(speed=1.5, delay=2.0)),
        (
            "b=random:within=4,radius=.2,height=1",
            "b",
            "random",
            None,
            Options(1, "mirror", 0, 0.2, 1, 4),
        ),
    ],
)
def test_a_word_says_who_walks_and_how(
    text: str, name: str, walker: str, points: object, options: Options
) -> None:
    (spec,) = parse_actors([text])
    assert (spec.name, spec.full_name, spec.walker) == (name, f"{name}_actor", walker)
    told = spec.told and (spec.told.points, spec.told.times, spec.told.loops, spec.told.delay)
    assert told == (points and (points, (), True, 0.0))
    assert spec.options == options


def test_a_file_names_its_people_unless_the_word_does(tmp_path: Path) -> None:
    one, two = tmp_path / "inspect_diag.sdf", tmp_path / "Two.WORLD"
    one.write_text(f"<trajectory>{LINE}</trajectory>")
    two.write_text("<sdf><actor name='a_actor'/><actor name='b'/></sdf>")
    assert actor_names([str(one), f"g={one}:speed=2", str(two)]) == tuple(
        f"{name}_actor" for name in ("diag", "g", "a", "b")
    )
    with pytest.raises(UsageError, match="has 2 actors with names; leave out 'g='"):
        parse_actors([f"g={two}"])
    one.write_text("<actor name='c d'/>")  # read anew, as it has changed
    assert actor_names([str(one)]) == ("c_d_actor",)
    one.write_text("<actor name='9'/>")
    with pytest.raises(UsageError, match="'9' cannot be part of a topic's name"):
        parse_actors([str(one)])


def test_the_people_of_a_terrain_are_the_actors_of_its_world(tmp_path: Path) -> None:
    world, empty = tmp_path / "a.WORLD", tmp_path / "b.sdf"
    world.write_text("<sdf><world><actor name='a'/></world></sdf>")
    empty.write_text("<sdf><world/></sdf>")
    (broken := tmp_path / "d.sdf").write_text("<sdf>")  # whoever loads the terrain is told
    assert of_terrain(str(world)) == (str(world),)
    nobodys = ("rocky", str(empty), str(broken), str(tmp_path / "c.sdf"))
    assert [of_terrain(name) for name in nobodys] == [()] * 4
    assert Run.of(terrain=str(world), actors=("b=1,2",)).people == (str(world), "b=1,2")


def test_the_people_of_a_terrain_are_those_of_what_it_includes_too(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    script = f"<script><trajectory>{LINE}</trajectory></script>"
    (tmp_path / "models" / "v.sdf").write_text(f"<sdf><actor name='v'>{script}</actor></sdf>")
    world = tmp_path / "w" / "a.world"
    world.parent.mkdir()
    include = "<include><uri>v.sdf</uri><pose>7 0 0 0 0 1.5707963267948966</pose></include>"
    for encoding in ("utf-8", "utf-16"):
        text = f"<sdf><world>{include}</world></sdf>".replace(">", ">\r\n")
        world.write_bytes(text.encode(encoding))
        config = Run.of(terrain=str(world), resource_path=(str(tmp_path / "models"),))
        (spec,) = config.actor_specs()
        assert spec.name == "v"
        assert spec.told is not None
        assert spec.told.points[0] == pytest.approx((5.0, 1.0, 3.0))
    (tmp_path / "models" / "v.sdf").write_text("<sdf><actor name='v'><script/></actor></sdf>")
    world.write_text(f"<sdf><world>{include}</world><!-- read anew --></sdf>")
    with pytest.raises(UsageError, match=r"v\.sdf has 0 way points"):
        config.actor_specs()


def test_a_file_is_found_beside_the_scenario_that_names_it() -> None:
    assert beside("g=way.sdf:speed=2", lambda name: Path("there", name)) == "g=there/way.sdf:speed=2"
    for name in ("way.world", "way.XML", "my\nway.sdf:speed=2"):
        assert beside(name, lambda name: Path("there", name)) == f"there/{name}"
    assert beside("g=1,2/3,4:speed=2", lambda name: Path("there", name)) == "g=1,2/3,4:speed=2"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("walker", r"'walker' is not valid; give \[NAME=\]FILE"),
        ("g=1,2/x", "is not valid; give"),
        ("1,2/3,4", "has no name; give"),
        ("9=random", "is not valid; give"),
        ("g=none.sdf", "none.sdf cannot be read"),
        ("g=random:speed=1=2", "speed '1=2' is not valid"),
        ("g=random:delay=", "delay '' is not valid; give 0 to"),
        ("g=random:speed=nan", "speed 'nan' is not valid"),
        ("g=random:spead=1", "key 'spead' does not exist; did you mean 'speed'"),
        ("g=1,2:route=round", "route 'round' does not exist; available: mirror, closed$"),
        ("g=random:push=0.5", "push '0.5' is not valid"),
        ("g=random:radius=0.5,height=0.8", "at least as high as wide"),
        ("g=random,g=social", "is not valid"),
    ],
)
def test_mistakes_are_told_with_what_is_valid(text: str, told: str) -> None:
    with pytest.raises(UsageError, match=told):
        parse_actors([text])


@pytest.mark.parametrize(
    ("form", "low", "high"),
    [
        ("speed={}", 0.05, 10),
        ("delay={}", 0, 1e6),
        ("height=3,radius={}", 0.05, 1),
        ("radius=0.05,height={}", 0.3, 3),
        ("within={}", 2, 500),
        ("push={}", 0, 1),
    ],
)
def test_limits_belong_to_what_is_valid(form: str, low: float, high: float) -> None:
    parse_actors([f"a=random:{form.format(low)}", f"b=random:{form.format(high)}"])
    for value in (low - 0.01, high + 0.01):
        with pytest.raises(UsageError, match=re.escape(f"is not valid; give {low:g} to {high:g}")):
            parse_actors([f"a=random:{form.format(value)}"])


def test_names_are_different_and_people_not_too_many() -> None:
    for name in "gG":
        with pytest.raises(UsageError, match=f"two actors are called '{name}'; give one another name"):
            parse_actors([f"{name}=1,2", f"{name}_actor=random"])
    assert len(parse_actors(["g=1,2", "G=1,2"])) == 2
    with pytest.raises(UsageError, match="101 actors are too many; give at most 100"):
        parse_actors([f"p{n}=random" for n in range(101)])
    assert len(parse_actors([f"p{n}=random:radius=0.5,height=1" for n in range(100)])) == 100
