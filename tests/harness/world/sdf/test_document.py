"""SDF documents: models, links, frames and includes of every version; what is left out is named once."""

import math
from pathlib import Path

import numpy as np
import pytest

from harness.errors import UsageError
from harness.world.sdf import document as module
from harness.world.sdf.document import Document, read_document
from harness.world.sdf.resources import Resources
from harness.world.solids.solid import MeshFile, Plane, Primitive, Relief

BOX = "<geometry><box><size>2 4 6</size></box></geometry>"
SUBMESH = "<submesh><name>s</name><center>1</center></submesh>"
MESH = f"<mesh><uri>m.obj</uri><scale>1 1 2</scale>{SUBMESH}</mesh>"
QUARTER = 0.5 * math.pi


def written(folder: Path, body: str, name: str = "a.world", version: str = "1.9") -> Path:
    path = folder / name
    path.write_text(f"<sdf version='{version}'>{body}</sdf>")
    return path


def read(folder: Path, body: str, version: str = "1.9") -> Document:
    path = written(folder, f"<world name='w'>{body}</world>", version=version)
    return read_document(path, Resources())


def model(body: str, name: str = "m", *, static: bool = True) -> str:
    return f"<model name='{name}'><static>{static}</static>{body}</model>"


def link(inner: str = "", collision: str = BOX, name: str = "l") -> str:
    return f"<link name='{name}'>{inner}<collision name='c'>{collision}</collision></link>"


@pytest.mark.parametrize("version", ["1.4", "1.6", "1.9"])
def test_poses_of_model_link_and_collision_nest(tmp_path: Path, version: str) -> None:
    turned = f"<pose frame=''>1 0 0 0 0 {QUARTER}</pose>"
    collision = (
        f"<pose>0 0 3 0 0 0</pose>{BOX}<surface><friction><ode><mu>0.4</mu></ode></friction></surface>"
    )
    document = read(tmp_path, model(turned + link("<pose>2 0 0 0 0 0</pose>", collision)), version)
    (solid,) = document.solids
    np.testing.assert_allclose(solid.pose[:3, 3], [1.0, 2.0, 3.0], atol=1e-12)
    np.testing.assert_allclose(solid.pose[:3, 0], [0.0, 1.0, 0.0], atol=1e-12)
    assert (solid.name, solid.shape) == ("m::l::c", Primitive("box", (1.0, 2.0, 3.0)))
    assert (solid.friction, document.name, document.gravity, document.notes) == (0.4, "w", 9.8, ())


@pytest.mark.parametrize(
    ("geometry", "shape"),
    [
        ("<sphere><radius>2</radius></sphere>", Primitive("ellipsoid", (2.0, 2.0, 2.0))),
        ("<ellipsoid><radii>1 2 3</radii></ellipsoid>", Primitive("ellipsoid", (1.0, 2.0, 3.0))),
        (
            "<cylinder><radius>2</radius><length>3</length></cylinder>",
            Primitive("cylinder", (2.0, 1.5)),
        ),
        ("<plane><size>7 8</size></plane>", Plane((0.0, 0.0, 1.0), (7.0, 8.0))),
        ("<plane/>", Plane((0.0, 0.0, 1.0), (1.0, 1.0))),
        ("<mesh><uri>m.obj</uri></mesh>", MeshFile(Path("m.obj"), (1.0, 1.0, 1.0), "", False)),
        (
            "<heightmap><uri>m.obj</uri></heightmap>",
            Relief(Path("m.obj"), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)),
        ),
        (
            MESH,
            MeshFile(Path("m.obj"), (1.0, 1.0, 2.0), "s", True),
        ),
        (
            "<heightmap><uri>file://m.obj</uri><size>9 8 7</size><pos>1 2 3</pos></heightmap>",
            Relief(Path("m.obj"), (9.0, 8.0, 7.0), (1.0, 2.0, 3.0)),
        ),
    ],
)
def test_every_shape_is_read(tmp_path: Path, geometry: str, shape: object) -> None:
    (tmp_path / "m.obj").touch()
    (solid,) = read(tmp_path, model(link(collision=f"<geometry>{geometry}</geometry>"))).solids
    told = repr(solid.shape).replace(f"{tmp_path}/", "")
    assert told == repr(shape)


def test_a_capsule_is_a_cylinder_between_two_balls(tmp_path: Path) -> None:
    capsule = "<geometry><capsule><radius>1</radius><length>4</length></capsule></geometry>"
    solids = read(tmp_path, model(link(collision=capsule))).solids
    ball = Primitive("ellipsoid", (1.0, 1.0, 1.0))
    assert [solid.shape for solid in solids] == [Primitive("cylinder", (1.0, 2.0)), ball, ball]
    assert [solid.pose[2, 3] for solid in solids] == [0.0, 2.0, -2.0]


def test_frames_place_links_models_and_collisions(tmp_path: Path) -> None:
    body = (
        "<frame name='f'><pose>10 0 0 0 0 0</pose></frame>"
        + model("<pose relative_to='f'>0 1 0 0 0 0</pose>" + link(), "one")
        + model(
            "<pose>0 5 0 0 0 0</pose><frame name='g' attached_to='k'><pose>0 0 1 0 0 0</pose></frame>"
            + link("<pose degrees='true'>1 0 0 0 0 180</pose>", name="k")
            + link("<pose relative_to='g'>0 0 1 0 0 0</pose>", name="l")
            + link("", f"<pose relative_to='k'>1 0 0 0 0 0</pose>{BOX}", "n"),
            "two",
        )
        + "<model name='three' placement_frame='p'><static>1</static><pose relative_to='two::k'/>"
        + "<frame name='p'><pose>0 0 4 0 0 0</pose></frame>"
        + link()
        + "</model>"
    )
    places = [solid.pose[:3, 3].round(9).tolist() for solid in read(tmp_path, body).solids]
    assert places == [[10, 1, 0], [1, 5, 0], [1, 5, 2], [0, 5, 0], [1, 5, -4]]


def test_includes_take_another_name_and_pose_and_find_their_own_files(tmp_path: Path) -> None:
    folder = tmp_path / "thing"
    folder.mkdir()
    (folder / "m.obj").touch()
    mesh = "<geometry><mesh><uri>m.obj</uri></mesh></geometry>"
    inner = "<pose>9 9 9 0 0 0</pose>" + link(collision=mesh)
    written(folder, f"<model name='own'>{inner}</model>", "model.sdf")
    include = "<include><uri>model://thing</uri><static>1</static>{}</include>"
    body = include.format("") + include.format("<name>other</name><pose>1 2 3 0 0 0</pose>")
    document = read(tmp_path, body + model(include.format("<pose>1 0 0 0 0 0</pose>"), "outer"))
    assert [solid.name for solid in document.solids] == ["outer::own::l::c", "own::l::c", "other::l::c"]
    assert [solid.pose[0, 3] for solid in document.solids] == [1.0, 9.0, 1.0]
    assert all(s.shape == MeshFile(folder / "m.obj") for s in document.solids)
    assert len(document.files) == 4
    assert document.notes == ()


def test_what_cannot_be_had_is_named_once_and_the_rest_is_read(tmp_path: Path) -> None:
    fuel = "<include><uri>https://fuel.gazebosim.org/1.0/rock</uri></include>"
    gone = link(collision="<geometry><mesh><uri>file:///home/x/m.dae</uri></mesh></geometry>")
    odd = link(collision="<geometry><polyline/></geometry>")
    arm = model("<joint name='j' type='revolute'/>" + link(), "arm", static=False)
    door = model("<joint name='j' type='revolute'/>" + link(), "door")
    ball = model(link(), "ball", static=False)
    plugin = "<plugin name='wind' filename='x'/>"
    bare = model("<link name='l'><collision name='c'/></link>", "bare")
    body = fuel * 2 + model(gone + odd) * 2 + arm + door + ball + plugin * 2 + bare + "<road/>"
    document = read(tmp_path, body)
    assert [solid.name for solid in document.solids] == ["door::l::c", "ball::l::c"]
    text = "\n".join(document.notes)
    for told in (
        "https://fuel.gazebosim.org/1.0/rock: nothing is fetched",
        "file:///home/x/m.dae: there is no such file",
        "shapes of the kind <polyline>",
        "model 'arm': it has joints that move",
        "bare::l::c: it has no <geometry>",
        "<road>",
        "plugins are not run: wind",
        "not static, but nothing moves here: ball",
    ):
        assert text.count(told) == 1, told
    assert len(document.notes) == 8


def test_visuals_give_colours_and_nothing_to_collide_with(tmp_path: Path) -> None:
    visual = f"<visual name='v'>{BOX}<material><diffuse>1 0 0 1</diffuse></material></visual>"
    document = read(tmp_path, model(link(visual) + f"<link name='k'>{visual}</link>"))
    assert [(s.name, s.color) for s in document.solids] == [("m::l::c", (1.0, 0.0, 0.0, 1.0))]


@pytest.mark.parametrize(
    ("materials", "color"),
    [
        (["<diffuse>0.1 0.2 0.3 0.4</diffuse>"], (0.1, 0.2, 0.3, 0.4)),
        (["<diffuse>0.1 0.2 0.3</diffuse>"], (0.1, 0.2, 0.3, 1.0)),
        (["<ambient>0.1 0.2 0.3</ambient><diffuse>1 0 0</diffuse>"], (1.0, 0.0, 0.0, 1.0)),
        (["<ambient>0.1 0.2 0.3</ambient>"], (0.1, 0.2, 0.3, 1.0)),
        (["", "<diffuse>0 0 1</diffuse>", "<diffuse>1 0 0</diffuse>"], (0.0, 0.0, 1.0, 1.0)),
        (["<diffuse>1 0</diffuse>"], None),
        ([], None),
    ],
)
def test_the_first_colour_of_a_links_visuals_is_that_of_its_collisions(
    materials: list[str], color: tuple[float, ...] | None, tmp_path: Path
) -> None:
    visuals = "".join(f"<visual name='v'><material>{text}</material></visual>" for text in materials)
    (solid,) = read(tmp_path, model(link(visuals))).solids
    assert solid.color == color


def test_gravity_friction_and_names_have_the_defaults_of_sdf(tmp_path: Path) -> None:
    bare = f"<model><link><collision>{BOX}</collision></link></model>"
    alone = read_document(written(tmp_path, bare, "yard.sdf"), Resources())
    assert (alone.name, alone.gravity, alone.movable) == ("yard", 9.8, ["model"])
    assert [(s.name, s.friction, s.color) for s in alone.solids] == [
        ("model::link::collision", None, None)
    ]
    moon = read(tmp_path, "<gravity>0 0 -1.62</gravity>" + model(link()))
    assert moon.gravity == 1.62
    slippery = BOX + "<surface><friction><ode><mu>0</mu></ode></friction></surface>"
    assert [s.friction for s in read(tmp_path, model(link("", slippery))).solids] == [0.0]
    plugins = "<plugin name='a'/><plugin filename='b'/><plugin/><plugin name='a'/>"
    assert read(tmp_path, plugins + "<population/>").notes == (
        "left out: <population>",
        "plugins are not run: a, b, ?",
    )
    for upward in ("0 0 0", "0 0 9.8"):
        with pytest.raises(UsageError, match="is not straight down"):
            read(tmp_path, f"<gravity>{upward}</gravity>")


def test_an_include_says_whether_its_model_is_static_and_a_model_says_it_of_those_within(
    tmp_path: Path,
) -> None:
    written(tmp_path, model(link(), static=False), "free.sdf")
    written(tmp_path, model(link()), "still.sdf")
    include = "<include><uri>{}.sdf</uri><name>{}</name>{}</include>"
    free, still = "<static>0</static>", "<static>true</static>"
    body = (
        include.format("free", "a", "")
        + include.format("free", "b", still)
        + include.format("still", "c", "")
        + include.format("still", "d", free)
        + model(include.format("free", "e", ""), "outer")
        + model(include.format("free", "g", ""), "loose", static=False)
    )
    document = read(tmp_path, body)
    assert document.movable == ["loose", "a", "d"]
    assert len(document.solids) == 6


def test_frames_of_joints_are_those_of_their_children_and_those_who_are_told_none_of_the_model(
    tmp_path: Path,
) -> None:
    inner = (
        link("<pose>1 0 0 0 0 0</pose>", name="k")
        + "<joint name='j' type='fixed'><child>k</child><pose>0 2 0 0 0 0</pose></joint>"
        + "<frame name='f'><pose relative_to='j'>0 0 3 0 0 0</pose></frame>"
        + link("<pose relative_to='f'>0 0 0 0 0 0</pose>", name="l")
    )
    inner += link(
        f"<pose>5 5 5 0 0 {QUARTER}</pose>", f"<pose relative_to='f'>0 0 1 0 0 0</pose>{BOX}", "n"
    )
    solids = read(tmp_path, model("<pose>10 0 0 0 0 0</pose>" + inner)).solids
    places = [solid.pose[:3, 3].round(9).tolist() for solid in solids]
    assert places == [[11, 0, 0], [11, 2, 3], [11, 2, 4]]
    np.testing.assert_allclose(solids[-1].pose[:3, :3], np.eye(3), atol=1e-12)


def test_more_collisions_than_anybody_draws_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MOST_SOLIDS", 2)
    assert len(read(tmp_path, model(link()) * 2).solids) == 2
    with pytest.raises(UsageError, match="more than 2 collisions; take some out"):
        read(tmp_path, model(link()) * 3)


def test_actors_of_included_files_are_in_the_frame_of_the_include(tmp_path: Path) -> None:
    actor = "<actor name='{}'><pose>0 3 0 0 0 0</pose></actor>"
    box = f"<model name='box'>{link()}</model>"
    written(tmp_path, actor.format("lone"), "lone.sdf")
    written(tmp_path, f"<world name='w'>{actor.format('worldly')}{box}</world>", "inner.world")
    written(tmp_path, f"<model name='box'>{link()}{actor.format('nested')}</model>", "model.sdf")
    written(tmp_path, box + actor.format("beside"), "beside.sdf")
    include = f"<include><uri>{{}}</uri>{{}}<pose>{{}} 0 1 0 0 {QUARTER}</pose></include>"
    body = (
        f"<frame name='f'><pose>100 0 0 0 0 0</pose></frame>{actor.format('own')}"
        + include.format("lone.sdf", "<name>guide</name>", 10)
        + include.format("lone.sdf", "", 20).replace("<pose>", "<pose relative_to='f'>")
        + include.format("inner.world", "", 30)
        + model(include.format("model.sdf", "", 40) + "<pose>1 0 0 0 0 0</pose>", "outer")
        + include.format("beside.sdf", "", 50)
    )
    document = read(tmp_path, body)
    places = {person.name: person.pose[:3, 3].round(9).tolist() for person in document.actors}
    # A lone actor's pose and name are the include's, as a model's; of others they are in its frame.
    assert places == {
        "own": [0, 3, 0],
        "guide": [10, 0, 1],
        "lone": [120, 0, 1],
        "worldly": [27, 0, 1],
        "nested": [38, 0, 1],
        "beside": [47, 0, 1],
    }
    np.testing.assert_allclose(document.actors[1].pose[:3, 0], [0.0, 1.0, 0.0], atol=1e-12)
    assert [solid.pose[0, 3] for solid in document.solids] == [41.0, 30.0, 50.0]
    assert document.notes == ("not static, but nothing moves here: w::box, sdf::box",)


def test_two_includes_of_one_name_stand_where_each_is_told_to(tmp_path: Path) -> None:
    written(tmp_path, f"<model name='m'><static>1</static>{link()}</model>", "m.sdf")
    include = "<include><uri>m.sdf</uri><pose>{} 0 0 0 0 0</pose></include>"
    solids = read(tmp_path, include.format(1) + include.format(2)).solids
    assert [solid.pose[0, 3] for solid in solids] == [1.0, 2.0]


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("<urdf/>", "neither <world> nor <model>"),
        ("<world><gravity>0 1 -9</gravity></world>", "not straight down"),
        ("<world><gravity>0 0 nan</gravity></world>", "gravity '0 0 nan' is not valid"),
        (f"<world>{model('<pose>1 2 3</pose>' + link())}</world>", "pose of m '1 2 3' is not valid"),
        (f"<world>{model('<pose relative_to=@x@/>')}</world>", "frame 'x' does not exist"),
        (
            f"<world>{model(link(collision=BOX.replace('2 4 6', '2 0 6')))}</world>",
            "give metres above 0",
        ),
        ("<world><include><uri>a.world</uri></include></world>", "includes itself: a.world -> a.world"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(tmp_path: Path, body: str, told: str) -> None:
    path = written(tmp_path, body.replace("@", "'"))
    with pytest.raises(UsageError, match=told) as raised:
        read_document(path, Resources())
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("inner", "told"),
    [
        ("<frame name='f'>@</frame>", "pose of f '1 2 3' is not valid"),
        ("<joint name='j' type='fixed'><child>l</child>@</joint>", "pose of j '1 2 3' is not valid"),
        ("<link name='k'>@</link>", "pose of k '1 2 3' is not valid"),
        (link("", f"@{BOX}"), "pose of m::l::c '1 2 3' is not valid"),
        (link("", "<geometry><box/></geometry>"), "<size> of m::l::c '' is not valid; give 3 finite"),
        (link("", BOX.replace("2 4 6", "1e6 1 1")), "<size> of m::l::c '1e6 1 1' is not valid"),
        (
            link("", "<geometry><plane><normal>0 0 0</normal></plane></geometry>"),
            "normal of m::l::c is 0",
        ),
        (
            link("", "<geometry><heightmap><uri>m.obj</uri><size>1 2</size></heightmap></geometry>"),
            "<size> of m::l::c '1 2' is not valid; give 3 finite numbers",
        ),
        (
            link("", "<geometry><mesh><uri>m.obj</uri><scale>1 0 1</scale></mesh></geometry>"),
            "<scale> of m::l::c is not valid; a factor is 0",
        ),
        (
            link("", BOX + "<surface><friction><ode><mu>x</mu></ode></friction></surface>"),
            "<mu> of m::l::c 'x' is not valid",
        ),
    ],
)
def test_a_number_that_is_not_valid_is_told_with_whose_it_is(
    inner: str, told: str, tmp_path: Path
) -> None:
    (tmp_path / "m.obj").touch()
    with pytest.raises(UsageError, match=told):
        read(tmp_path, model(inner.replace("@", "<pose>1 2 3</pose>")))


def test_a_model_alone_is_a_world_and_of_several_worlds_the_first_counts(tmp_path: Path) -> None:
    alone = read_document(written(tmp_path, f"<model name='m'>{link()}</model>"), Resources())
    assert [solid.name for solid in alone.solids] == ["m::l::c"]
    two = f"<world name='a'>{model(link())}</world><world name='b'>{model(link())}</world>"
    document = read_document(written(tmp_path, two), Resources())
    assert (document.name, len(document.solids)) == ("a", 1)
    assert "all worlds of the file but the first" in document.notes[0]


def test_includes_that_double_themselves_are_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MOST_INCLUDES", 60)
    for depth in range(6):
        twice = f"<include><uri>{depth + 1}.sdf</uri></include>" * 2
        written(tmp_path, f"<model name='m'>{twice if depth < 5 else link()}</model>", f"{depth}.sdf")
    with pytest.raises(UsageError, match="more than 60 includes"):
        read_document(tmp_path / "0.sdf", Resources())
    monkeypatch.setattr(module, "MOST_INCLUDES", 62)  # 2 + 4 + 8 + 16 + 32
    assert len(read_document(tmp_path / "0.sdf", Resources()).solids) == 32
