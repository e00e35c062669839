"""SDF documents: models, links, frames and includes of every version; what is left out is named once."""

import re
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.base.sdf import scopes
from harness.base.sdf.resources import Resources
from harness.base.xml import read_xml
from harness.world.sdf import reading as module
from harness.world.sdf.document import Document
from harness.world.sdf.reading import read_document
from harness.world.solid import MeshFile, Plane, Primitive, Relief
from tests.harness.world.solids.shapes import at

BOX = "<geometry><box><size>2 4 6</size></box></geometry>"
MESH = "<uri>m.obj</uri><scale>1 2 -3</scale><submesh><name>s</name><center>1</center></submesh>"
HILL = "<uri>file://m.obj</uri><size>9 8 7</size><pos>1 2 3</pos>"
MU = "<surface><friction><ode><mu>{}</mu></ode></friction></surface>"
GRAVITY = "<world><gravity>{}</gravity></world>"
BAD = "<pose>1 2 3</pose>"
A, B, C, D = np.random.default_rng(0).uniform(-1.5, 1.5, (4, 6)).round(3).tolist()


def written(folder: Path, body: str, name: str = "a.world") -> Path:
    path = folder / name
    path.write_text(f"<sdf version='1.9'>{body}</sdf>")
    return path


def read_file(folder: Path, body: str) -> Document:
    return read_document(written(folder, body), Resources())


def read(folder: Path, body: str) -> Document:
    return read_file(folder, f"<world name='w'>{body}</world>")


def pose(numbers: list[float], relative_to: str = "") -> str:
    note = f" relative_to='{relative_to}'" if relative_to else " frame='x'"  # of old files: nothing
    return f"<pose{note}>{' '.join(map(str, numbers))}</pose>"


def assert_placed(document: Document, expected: list[tuple[str, np.ndarray]]) -> None:
    assert [solid.name for solid in document.solids] == [name for name, _ in expected]
    places = [solid.pose for solid in document.solids]
    np.testing.assert_allclose(places, [place for _, place in expected], atol=1e-9)


def geometry(kind: str, inner: str = "") -> str:
    return f"<geometry><{kind}>{inner}</{kind}></geometry>"


def model(body: str, name: str = "m", *, static: bool = True) -> str:
    return f"<model name='{name}'><static>{static}</static>{body}</model>"


def link(inner: str = "", collision: str = BOX, name: str = "l") -> str:
    return f"<link name='{name}'>{inner}<collision name='c'>{collision}</collision></link>"


@pytest.mark.parametrize(
    ("kind", "inner", "shape"),
    [
        ("box", "<size>2 4 6</size>", Primitive("box", (1.0, 2.0, 3.0))),
        ("sphere", "<radius>2</radius>", Primitive("ellipsoid", (2.0, 2.0, 2.0))),
        ("ellipsoid", "<radii>1 2 3</radii>", Primitive("ellipsoid", (1.0, 2.0, 3.0))),
        ("plane", "<normal>1 2 3</normal><size>7 8</size>", Plane((1.0, 2.0, 3.0), (7.0, 8.0))),
        ("plane", "", Plane((0.0, 0.0, 1.0), (100.0, 100.0))),
        ("mesh", "<uri>m.obj</uri>", MeshFile(Path("m.obj"), (1.0, 1.0, 1.0), "", False)),
        ("mesh", MESH, MeshFile(Path("m.obj"), (1.0, 2.0, -3.0), "s", True)),
        ("heightmap", "<uri>m.obj</uri>", Relief(Path("m.obj"), None, (0.0, 0.0, 0.0))),
        ("heightmap", HILL, Relief(Path("m.obj"), (9.0, 8.0, 7.0), (1.0, 2.0, 3.0))),
    ],
)
def test_every_shape_is_read(tmp_path: Path, kind: str, inner: str, shape: object) -> None:
    (tmp_path / "m.obj").touch()
    (solid,) = read(tmp_path, model(link(collision=geometry(kind, inner)))).solids
    assert repr(solid.shape).replace(f"{tmp_path}/", "") == repr(shape)
    capsule = geometry("capsule", "<radius>1</radius><length>4</length>")
    solids, ball = (
        read(tmp_path, model(link(collision=capsule))).solids,
        Primitive("ellipsoid", (1.0,) * 3),
    )
    assert [solid.shape for solid in solids] == [Primitive("cylinder", (1.0, 2.0)), ball, ball]
    assert [solid.pose[:3, 3].tolist() for solid in solids] == [[0, 0, 0], [0, 0, 2], [0, 0, -2]]


def test_frames_place_links_models_and_collisions(tmp_path: Path) -> None:
    """Poses that turn about all axes: another order of two, or another frame, is another place."""
    a, b, c, d = (at(*numbers) for numbers in (A, B, C, D))
    deep = model(pose(C) + link("<pose frame='x'/>"), "deep")
    inner = (
        link(pose(B), name="k")
        + f"<frame name='g' attached_to='k'>{pose(C)}</frame>"
        + f"<joint name='j' type='fixed'><parent>world</parent><child>k</child>{pose(D)}</joint>"
        + link(pose(A, "g"), name="l")
        + link(pose(A, "j"), name="m")
        + link(pose(D), pose(C, "k") + BOX, "n")
        + link(pose(D), pose(C, "__model__") + BOX, "o")
        + model(pose(B) + link(pose(C), pose(D, "__model__") + BOX) + deep, "in")
    )
    body = (
        f"<frame name='f'>{pose(A)}</frame><frame name='h' attached_to='f'>{pose(B, 'world')}</frame>"
        + model(pose(B, "f") + link(pose(C), pose(D) + BOX), "one")
        + model(pose(C, "h") + link(), "two")
        + model(pose(A) + inner, "three")
        + model(pose(D, "three::in::deep::l") + link(), "four")
    )
    expected = [
        ("one::l::c", a @ b @ c @ d),
        ("two::l::c", b @ c),
        *(("three::k::c", a @ b), ("three::l::c", a @ b @ c @ a), ("three::m::c", a @ b @ d @ a)),
        *(("three::n::c", a @ b @ c), ("three::o::c", a @ c), ("three::in::l::c", a @ b @ d)),
        *(("three::in::deep::l::c", a @ b @ c), ("four::l::c", a @ b @ c @ d)),
    ]
    assert_placed(read(tmp_path, body), expected)


def test_includes_take_another_name_and_pose_and_find_their_own_files(tmp_path: Path) -> None:
    a, b, c, d = (at(*numbers) for numbers in (A, B, C, D))
    folder = tmp_path / "thing"
    folder.mkdir()
    (folder / "m.obj").touch()
    inner = link(collision=geometry("mesh", "<uri>m.obj</uri>"))
    frames = f"{pose(A)}<frame name='p'>{pose(B)}</frame><frame name='q'>{pose(C)}</frame>"
    written(folder, f"<model name='own' placement_frame='p'>{frames}{inner}</model>", "model.sdf")
    include = "<include><uri>model://thing</uri><static>1</static>{}</include>"
    body = (
        include.format("")
        + include.format(pose(D))  # which has the same name
        + include.format(f"<name>other</name><placement_frame>q</placement_frame>{pose(D)}")
        + model(pose(A, "twin::p") + include.format(pose(C)), "outer")  # of the first twin
        + "".join(model(f"<frame name='p'>{pose(there)}</frame>", "twin") for there in (D, B))
        + model(pose(C, "own") + link(), "beside")  # the first of that name
        + model(pose(A, "other::p") + link(), "upon")
    )
    document = read(tmp_path, body)
    expected = [
        ("outer::own::l::c", d @ a @ c @ np.linalg.inv(b)),
        ("beside::l::c", a @ np.linalg.inv(b) @ c),
        ("upon::l::c", d @ np.linalg.inv(c) @ b @ a),
        ("own::l::c", a @ np.linalg.inv(b)),
        ("own::l::c", d @ np.linalg.inv(b)),
        ("other::l::c", d @ np.linalg.inv(c)),
    ]
    assert_placed(document, expected)
    meshes = [solid.shape == MeshFile(folder / "m.obj") for solid in document.solids]
    assert meshes == [True, False, False, True, True, True]
    assert document.files == [tmp_path / "a.world", *[folder / "model.sdf"] * 4]
    assert document.notes == ()


def test_what_is_merged_is_part_of_its_model_and_what_is_changed_is_told(tmp_path: Path) -> None:
    thing = model(pose(A) + link(pose(B), name="k"), "thing")
    (tmp_path / "thing.sdf").write_text(f"<sdf>{thing}</sdf>")
    params = "<experimental:params><link element_id='k' action='remove'/></experimental:params>"
    include = "<include merge='true'><uri>thing.sdf</uri>{}{}</include>".format
    read_ = read(tmp_path, model(include(pose(D), params) + link(pose(C, "k"), name="l")))
    b, c, d = (at(*numbers) for numbers in (B, C, D))
    assert_placed(read_, [("m::l::c", d @ b @ c), ("m::thing::k::c", d @ b)])
    assert any("experimental:params" in note for note in read_.notes)


def test_what_cannot_be_had_is_named_once_and_the_rest_is_read(tmp_path: Path) -> None:
    fuel = "<include><uri>https://fuel.gazebosim.org/1.0/rock</uri></include>"
    written(tmp_path, model(link(), "kept"), "kept.sdf")
    kept = "<include><uri>kept.sdf</uri></include>"
    gone = link(collision=geometry("mesh", "<uri>file:///home/x/m.dae</uri>"))
    odd = link(collision=geometry("polyline"))
    fixed, hinge = (f"<joint name='j' type='{kind}'/>" for kind in ("fixed", "revolute"))
    body = fuel * 2 + kept + model(gone + odd) * 2 + model(hinge + fixed + link(), "arm", static=False)
    body += model(hinge + link(), "door") + model(fixed + link(), "ball", static=False)
    body += "<plugin name='wind' filename='x'/>" * 2 + model(link(collision=geometry("empty")), "empty")
    body += model("<link name='l'><collision name='c'/></link>", "bare") + "<road/>"
    document = read(tmp_path, body)
    assert [solid.name for solid in document.solids] == ["door::l::c", "ball::l::c", "kept::l::c"]
    assert [re.sub("^left out: |; .*", "", note) for note in document.notes] == [
        "<road>",
        "https://fuel.gazebosim.org/1.0/rock: nothing is fetched",
        "file:///home/x/m.dae: there is no such file on this machine",
        "shapes of the kind <polyline>",
        "model 'arm': it has joints that move",
        "bare::l::c: it has no <geometry>",
        "plugins are not run: wind",
        "not static, but nothing moves here: ball",
    ]


@pytest.mark.parametrize(("latitude", "told"), [("0", 0), ("-0.0", 0), ("46.9", 1)])
def test_a_place_on_earth_is_told_with_the_option_that_says_it(
    latitude: str, told: int, tmp_path: Path
) -> None:
    place = f"<latitude_deg>{latitude}</latitude_deg><longitude_deg>0.0</longitude_deg>"
    read_ = read(tmp_path, model(link()) + f"<spherical_coordinates>{place}</spherical_coordinates>")
    assert sum("--datum 46.9,0.0,0" in note for note in read_.notes) == len(read_.notes) == told


@pytest.mark.parametrize(
    "uri", ["model://ground_plane", "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground%20Plane"]
)
def test_gazebos_own_ground_and_sun_need_no_file_and_what_tinyxml_takes_is_taken(
    tmp_path: Path, uri: str
) -> None:
    """A bare attribute as in DynaBARN's worlds, and a late declaration; an own plane counts first."""
    sun = "<include><uri>model://sun</uri></include>"
    body = f"{sun}<include><uri>{uri}</uri><pose frame=>{' '.join(map(str, A))}</pose></include>"
    document = read(tmp_path, body)
    assert_placed(document, [("ground_plane::link::collision", at(*A))])
    assert isinstance(document.solids[0].shape, Plane)
    assert document.notes == ()
    (tmp_path / "ground_plane").mkdir()
    (tmp_path / "ground_plane" / "model.sdf").write_text(
        f"\n<!-- by hand -->\n<?xml version='1.0'?><sdf version='1.9'>{model(link())}</sdf>"
    )
    own = read(tmp_path, "<include><uri>model://ground_plane</uri></include>")
    assert [solid.name for solid in own.solids] == ["m::l::c"]


@pytest.mark.parametrize(
    ("materials", "color"),
    [
        (["<diffuse>0.1 0.2 0.3 0.4</diffuse>"], (0.1, 0.2, 0.3, 0.4)),
        (["<ambient>0.1 0.2 0.3</ambient><diffuse>1 0 0</diffuse>"], (1.0, 0.0, 0.0, 1.0)),
        (["", "<ambient>0 0 1</ambient>", "<diffuse>1 0 0</diffuse>"], (0.0, 0.0, 1.0, 1.0)),
        (["<diffuse>1 0</diffuse>"], None),
    ],
)
def test_the_first_colour_of_a_links_visuals_is_that_of_its_collisions(
    materials: list[str], color: tuple[float, ...] | None, tmp_path: Path
) -> None:
    visuals = "".join(f"<visual name='v'><material>{text}</material></visual>" for text in materials)
    (solid,) = read(tmp_path, model(link(visuals) + f"<link name='k'>{visuals}</link>")).solids
    assert (solid.name, solid.color) == ("m::l::c", color)


def test_a_plugin_that_steers_an_actor_is_told(tmp_path: Path) -> None:
    actors = "<actor name='a'><plugin name='p'/></actor><actor name='b'/>"
    (note,) = read(tmp_path, actors).notes
    assert "actor 'a', who stands still" in note


def test_models_stand_where_gazebo_classic_saved_them(tmp_path: Path) -> None:
    link = f"<link name='l'><collision name='c'>{BOX}</collision></link>"
    models = model(pose(A) + link, "a", static=False) + model(pose(B) + link, "b")
    states = [f"<model name='{n}'>{pose(p)}</model>" for n, p in (("a", C), ("b", B), ("gone", D))]
    document = read(tmp_path, f"{models}<state world_name='w'>{''.join(states)}</state>")
    assert_placed(document, [("a::l::c", at(*C)), ("b::l::c", at(*B))])
    assert document.restored == ["a"]


def test_gravity_friction_and_names_have_the_defaults_of_sdf(tmp_path: Path) -> None:
    bare = f"<model><link><collision>{BOX}</collision></link></model>"
    alone = read_document(written(tmp_path, bare, "yard.sdf"), Resources())
    assert (alone.gravity, alone.movable) == (9.8, ["model"])
    (only,) = alone.solids
    assert (only.name, only.friction, only.color) == ("model::link::collision", None, None)
    assert read_file(tmp_path, GRAVITY.format("0 0 -1.62")).gravity == 1.62
    slippery = "".join(model(link("", BOX + MU.format(mu))) for mu in ("0", "0.4"))
    assert [s.friction for s in read(tmp_path, slippery).solids] == [0.0, 0.4]
    plugins = "<plugin name='a'/><plugin filename='b'/><plugin/><plugin name='a'/>"
    document = read_file(tmp_path, f"<world>{plugins}<population/></world><world name='c'/>")
    left = ("all worlds of the file but the first", "<population>")
    assert document.notes == (*(f"left out: {name}" for name in left), "plugins are not run: a, b, ?")
    written(tmp_path, model(link(), static=False), "free.sdf")
    written(tmp_path, model(link()), "still.sdf")
    include = "<include><uri>{}.sdf</uri><name>{}</name>{}</include>".format
    body = include("free", "a", "") + include("free", "b", "<static>true</static>")
    body += include("still", "c", "") + include("still", "d", "<static>0</static>")
    body += model(include("free", "e", ""), "outer")
    body += model(include("free", "g", ""), "loose", static=False)
    document = read(tmp_path, body)
    assert (document.movable, len(document.solids)) == (["loose", "a", "d"], 6)


def wrong(inner: str) -> str:
    return f"<world>{model(inner)}</world>"


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (
            '<!DOCTYPE l [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]><sdf>&b;</sdf>',
            "a.world: it declares a document type or entities",
        ),
        ('<!DOCTYPE s SYSTEM "file:///etc/passwd"><sdf/>', "declares a document type"),
        ("<sdf>&later;</sdf>", "not XML: undefined entity"),
        ("<sdf><world></sdf>", "not XML: mismatched tag: line 1"),
        ("<?xml version='1.0'?>" + "<a>" * 101 + "</a>" * 101, "nested more than 100 deep"),
        ("<?xml version='1.0'?><urdf/>", "its root is <urdf>, not <sdf>"),
        ("<urdf/>", "neither <world> nor <model>"),
        *((GRAVITY.format(g), "not straight down") for g in ("0 1 -9", "1 0 -9", "0 0 0")),
        (GRAVITY.format("0 0 nan"), "gravity '0 0 nan' is not valid"),
        ("<world><include><uri>a.world</uri></include></world>", "includes itself: a.world -> a.world"),
        (wrong("<pose relative_to='x'/>"), "frame 'x' does not exist"),
        ("<world><include><uri>b.sdf</uri></include></world>", "a.world -> b.sdf -> c.sdf -> b.sdf"),
        (wrong("<pose rotation_format='quat_xyzw'>1 2 3 0 0 0 0</pose>"), "m .* its quaternion is 0"),
        (wrong(BAD + link()), "pose of m '1 2 3' is not valid"),
        *(
            (wrong(f"<{tag} name='f'>{BAD}</{tag}>"), "pose of f '1 2 3' is not valid")
            for tag in ("frame", "joint", "link")
        ),
        (wrong(link("", BAD + BOX)), "pose of m::l::c '1 2 3' is not valid"),
        (wrong(link("", BOX.replace("4", "0"))), "<size> of m::l::c '2 0 6' .* give metres above 0"),
        (wrong(link("", BOX.replace("4", "1e6"))), "<size> of m::l::c '2 1e6 6' is not valid"),
        (wrong(link("", geometry("plane", "<normal>0 0 0</normal>"))), "normal of m::l::c is 0"),
        (wrong(link("", geometry("mesh", "<scale>1 0 1</scale>"))), "<scale> of m::l::c is not valid"),
        (wrong(link("", BOX + MU.format("x"))), "<mu> of m::l::c 'x' is not valid"),
    ],
)
def test_what_is_wrong_is_one_line_that_says_where_it_is(tmp_path: Path, body: str, said: str) -> None:
    (tmp_path / "m.obj").touch()
    for name, other in ("bc", "cb"):
        written(tmp_path, model(f"<include><uri>{other}.sdf</uri></include>"), f"{name}.sdf")
    path = written(tmp_path, body)
    if body.startswith(("<!", "<?", "<sdf")):
        path.write_text(body)
    with pytest.raises(UsageError, match=said) as raised:
        read_document(path, Resources())
    assert "\n" not in str(raised.value)


def test_includes_that_double_themselves_are_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """2 + 4 + 8 + 16 + 32 includes, the last of which bring a box each."""
    for depth in range(6):
        twice = f"<include><uri>{depth + 1}.sdf</uri></include>" * 2
        written(tmp_path, f"<model name='m'>{twice if depth < 5 else link()}</model>", f"{depth}.sdf")
    for includes, solids, note in ((61, 32, "61 includes"), (62, 31, "31 collisions"), (62, 32, "")):
        monkeypatch.setattr(scopes, "MOST_INCLUDES", includes)
        monkeypatch.setattr(module, "MOST_SOLIDS", solids)
        with pytest.raises(UsageError, match=f"more than {note}; take") if note else nullcontext():
            assert len(read_document(tmp_path / "0.sdf", Resources()).solids) == 32


def test_models_in_no_world_are_loose_but_one_mesh_alone(tmp_path: Path) -> None:
    collision = "<collision name='c'><geometry>{}</geometry></collision>"
    box, mesh = "<box><size>1 1 1</size></box>", "<mesh><uri>m.obj</uri></mesh>"
    (tmp_path / "m.obj").touch()
    for text, solids, is_loose in (
        ("<?xml version='1.0'?>\n{box}{mesh}", 2, True),
        ("{mesh}", 1, True),
        ("<sdf>{box}{mesh}</sdf>", 2, True),
        ("<sdf>{box}</sdf>", 1, True),
        ("<sdf>{mesh}</sdf>", 1, False),
        ("<sdf><world name='w'>{box}{box}</world></sdf>", 2, False),
    ):
        models = {
            name: f"<model name='{name}'><link name='l'>{collision.format(shape)}</link></model>"
            for name, shape in (("box", box), ("mesh", mesh))
        }
        (tmp_path / "a.sdf").write_text(text.format(**models))
        document = read_document(tmp_path / "a.sdf", Resources([]))
        assert (len(document.solids), document.is_loose) == (solids, is_loose), text
        assert document.files == [tmp_path / "a.sdf"]


def test_a_large_or_missing_file_is_refused_and_a_hundred_elements_in_each_other_are_read(
    tmp_path: Path,
) -> None:
    path = tmp_path / "a.world"
    path.write_text("<sdf>" + " " * 100 + "</sdf>")
    with pytest.raises(UsageError, match="larger than 110 bytes"):
        read_xml(path, most_bytes=110)
    assert read_xml(path, most_bytes=111).tag == "sdf"
    with pytest.raises(UsageError, match=r"cannot read .*: No such file"):
        read_xml(tmp_path / "b.world")
    with pytest.raises(UsageError, match="embedded null byte"):
        read_xml(tmp_path / "b\0.world")
    path.write_text("<a>" * 99 + "<b/><c/>" + "</a>" * 99)
    assert [element.tag for element in read_xml(path).iter()] == ["a"] * 99 + ["b", "c"]
