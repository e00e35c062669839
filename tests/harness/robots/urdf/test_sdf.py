"""Rovers in SDF, whatever frames their file uses: the same model as of the URDF that says the same."""

import math
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.base.xml import parse_xml
from harness.robots.model import read_model
from harness.robots.urdf import sdf_model
from harness.robots.urdf.folder import Written, write_folder
from harness.robots.urdf.templates import TEMPLATES, urdf_of
from tests.support.foreign_rovers import BUGGY, HUSKY

Matrix = NDArray[np.float64]
URDFS = {"husky": HUSKY.urdf, "buggy": BUGGY.urdf, "rocker": urdf_of("r", TEMPLATES["rocker"])}
NEAR = 1e-5  # MuJoCo writes six digits
INCLUDED = {
    " in a world": "<sdf version='1.9'><world name='w'><include><uri>{}</uri></include></world></sdf>",
    " in a model": """<sdf version='1.9'><model name='o'><include merge='true'><uri>{}</uri>
      <pose>0 0 0 0 0 0</pose></include></model></sdf>""",
    " as a part": """<sdf version='1.9'><model name='o'><include><uri>{}</uri><name>p</name>
      <pose>0 0 0 0 0 0</pose></include></model></sdf>""",
}
# how poses of joints and axes are given
STYLES = ("1.4", "1.6", "1.6 of the model", "1.9", *(f"1.4{where}" for where in INCLUDED))


def pose_of(element: ET.Element | None) -> Matrix:
    pose = np.eye(4)
    if element is not None:
        pose[:3, 3] = [float(word) for word in element.get("xyz", "0 0 0").split()]
        angles = [float(word) for word in element.get("rpy", "0 0 0").split()]
        pose[:3, :3] = Rotation.from_euler("xyz", angles).as_matrix()
    return pose


def drawn(rng: np.random.Generator, shift: float) -> Matrix:
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(rng=rng).as_matrix()
    pose[:3, 3] = rng.uniform(-shift, shift, 3)
    return pose


def words(values: NDArray[np.float64]) -> str:
    return " ".join(f"{value:.15g}" for value in np.ravel(values))


def put(above: ET.Element, pose: Matrix, **attributes: str) -> None:
    angles = Rotation.from_matrix(pose[:3, :3]).as_euler("xyz")
    ET.SubElement(above, "pose", attributes).text = f"{words(pose[:3, 3])} {words(angles)}"


def texts(above: ET.Element, source: ET.Element) -> None:
    for tag, text in source.items():
        ET.SubElement(above, tag).text = text


class Sdf:
    """A URDF as SDF, with its links' frames anywhere and its joints turned at will."""

    def __init__(self, urdf: str, style: str) -> None:
        self.robot, self.style = parse_xml(urdf.encode()), style
        self.rng = np.random.default_rng(len(style))
        self.joints = {ends(joint)[1]: joint for joint in self.robot.findall("joint")}
        self.own: dict[str, Matrix] = {}
        self.sdf = ET.Element("sdf", version=style.split(maxsplit=1)[0])
        self.model = ET.SubElement(self.sdf, "model", name="m")
        put(self.model, drawn(self.rng, 5.0))  # where it stands in a world, which is no matter
        for link in self.robot.findall("link"):
            self.add_link(link, link.get("name", ""))
        for child, joint in self.joints.items():
            self.add_joint(child, joint)
        plugin = ET.SubElement(self.model, "plugin", name="drive")
        for joint in self.robot.iterfind("transmission/joint"):
            ET.SubElement(plugin, "left_joint").text = joint.get("name")

    def moves(self, link: str) -> bool:
        return link in self.joints and self.joints[link].get("type") != "fixed"

    def placed(self, link: str) -> Matrix:
        if link not in self.joints:
            return np.eye(4)
        joint = self.joints[link]
        return self.placed(ends(joint)[0]) @ pose_of(joint.find("origin"))

    def add_link(self, link: ET.Element, name: str) -> None:
        self.own[name] = self.placed(name) @ (drawn(self.rng, 0.3) if self.moves(name) else np.eye(4))
        written = ET.SubElement(self.model, "link", name=name)
        put(written, self.own[name])
        on = ET.SubElement(self.model, "frame", name=f"on {name}", attached_to=name)
        put(on, drawn(self.rng, 0.3), relative_to="__model__")
        for part in link:
            copy = ET.SubElement(written, part.tag, name=part.tag)
            shift = np.linalg.inv(self.own[name]) @ self.placed(name)
            put(copy, shift @ pose_of(part.find("origin")))
            if part.tag == "inertial":
                ET.SubElement(copy, "mass").text = next(part.iter("mass")).get("value")
                texts(ET.SubElement(copy, "inertia"), next(part.iter("inertia")))
            else:
                shape = next(part.iter("geometry"))[0]
                texts(ET.SubElement(ET.SubElement(copy, "geometry"), shape.tag), shape)

    def add_joint(self, child: str, joint: ET.Element) -> None:
        written = ET.SubElement(
            self.model, "joint", name=joint.get("name", ""), type=joint.get("type", "")
        )
        for tag, link in zip(("parent", "child"), ends(joint), strict=True):
            ET.SubElement(written, tag).text = f"{link} at {child}" if self.style == "1.9" else link
            tied = ET.SubElement(
                self.model, "frame", name=f"{link} at {child}", attached_to=f"on {link}"
            )
            put(tied, drawn(self.rng, 0.3))
        turned, root = self.placed(child) @ drawn(self.rng, 0.0), next(iter(self.own))
        stated = {"relative_to": root} if self.style == "1.9" else {}
        put(written, np.linalg.inv(self.own[root if stated else child]) @ turned, **stated)
        if not self.moves(child):
            return
        axis = ET.SubElement(written, "axis")
        vector = [float(word) for word in next(joint.iter("axis")).get("xyz", "").split()]
        frame = {"1.6": turned, "1.9": self.own[child]}.get(self.style, np.eye(4))
        xyz = ET.SubElement(axis, "xyz", {"expressed_in": child} if stated else {})
        xyz.text = words(frame[:3, :3].T @ self.placed(child)[:3, :3] @ vector)
        if self.style == "1.6 of the model":
            ET.SubElement(axis, "use_parent_model_frame").text = "1"
        for limit in joint.iter("limit"):
            texts(ET.SubElement(axis, "limit"), limit)
        for mimic in joint.iter("mimic"):
            texts(ET.SubElement(axis, "mimic", joint=mimic.get("joint", "")), mimic)


def ends(joint: ET.Element) -> tuple[str, str]:
    parent, child = (next(joint.iter(tag)).get("link", "") for tag in ("parent", "child"))
    return parent, child


def written(folder: Path, text: str, name: str) -> Written:
    (folder / name).write_text(text)
    return write_folder("made", folder / name, folder / f"{name}_made")


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("rover", URDFS)
def test_frames_of_links_and_joints_are_no_matter(rover: str, style: str, tmp_path: Path) -> None:
    text = ET.tostring(Sdf(URDFS[rover], style).sdf, encoding="unicode")
    if (where := style.removeprefix("1.4")) in INCLUDED:
        (tmp_path / "old.sdf").write_text(text)
        text = INCLUDED[where].format("old.sdf")
    ours = written(tmp_path, text, "model.sdf")
    urdf = URDFS[rover]
    if where == " as a part":
        urdf = re.sub(r"""(<(link|joint) name=|\b(link|joint)=)(["'])""", r"\1\4p_", urdf)
    theirs = written(tmp_path, urdf, "robot.urdf")
    assert ours.rover.drive == theirs.rover.drive
    one, other = (read_model(made.rover).compile() for made in (ours, theirs))
    first, second = mujoco.MjData(one), mujoco.MjData(other)
    for joint in range(1, one.njnt):  # somewhere within their limits
        first.qpos[6 + joint] = second.qpos[6 + joint] = 0.1 * joint / one.njnt
    mujoco.mj_forward(one, first)
    mujoco.mj_forward(other, second)
    for kind in ("body", "jnt", "actuator"):
        count = getattr(one, f"n{kind.replace('actuator', 'u')}")
        of_kind = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper().replace('JNT', 'JOINT')}")
        names = [mujoco.mj_id2name(one, of_kind, index) for index in range(count)]
        assert names == [mujoco.mj_id2name(other, of_kind, index) for index in range(count)]
    for name in ("body_mass", "jnt_range", "jnt_type", "actuator_forcerange", "actuator_ctrlrange"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), abs=NEAR), name
    assert one.eq_data == pytest.approx(other.eq_data, abs=NEAR)
    for name in ("xipos", "xanchor", "xaxis", "geom_xpos", "site_xpos"):
        assert getattr(first, name) == pytest.approx(getattr(second, name), abs=NEAR), name
    force, their_force = (np.zeros((model.nv, model.nv)) for model in (one, other))
    mujoco.mj_fullM(one, first, force)
    mujoco.mj_fullM(other, second, their_force)
    assert force == pytest.approx(their_force, abs=1e-4)


WHEEL = """<sdf version='1.9'><model name='wheel'><link name='link'>
  <inertial><mass>2</mass><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.02</izz></inertia></inertial>
  <collision name='c'><pose degrees='true'>0 0 0 90 40 0</pose><geometry><cylinder>
    <radius>0.15</radius><length>0.1</length></cylinder></geometry></collision></link></model></sdf>"""


def of_parts(more: str = "", kind: str = "revolute", part: str = "left::link") -> str:
    """A rover of two included wheels and a ball beside another model of its world."""
    wheels = "".join(
        f"""<include><uri>model://wheel</uri><name>{side}</name><pose>0.2 {y} 0.15 0 0 0</pose></include>
        <joint name='{side}' type='{kind if side == "left" else "continuous"}'><parent>chassis</parent>
        <child>{part if side == "left" else "right::link"}</child>
        <axis><xyz expressed_in='__model__'>0 1 0</xyz><dynamics><damping>0.1</damping></dynamics>
        <limit><lower>{end}</lower><upper>{-end}</upper><effort>5</effort><velocity>8</velocity></limit>
        </axis></joint>"""
        for side, y, end in (("left", 0.3, -math.inf), ("right", -0.3, 0.0))
    )
    inertia = "<inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz></inertia>"
    return f"""<sdf version='1.9'><world name='w'><include><uri>model://ground_plane</uri></include>
      <model name='gate'><static>1</static><joint type='revolute'/></model>
      <model name='rover'><pose>4 5 0 0 0 1</pose><link name='chassis'><pose>0 0 0.25 0 0 0</pose>
      <inertial><mass>8</mass>{inertia}</inertial>
      <collision name='c'><geometry><box><size>0.6 0.4 0.2</size></box></geometry></collision>
      <visual name='cone'><geometry><cone><radius>1</radius></cone></geometry></visual>
      <visual name='hood'><geometry><mesh><uri>hood.stl</uri><submesh><name>a</name></submesh></mesh>
      </geometry></visual>
      <visual name='old'><geometry><mesh><filename>shell.stl</filename></mesh></geometry></visual>
      <sensor name='cliff' type='ray'><ray><scan><horizontal><samples>1</samples></horizontal></scan>
      </ray></sensor>
      <sensor name='imu' type='imu'><pose>0 0.05 0 0 0 0</pose>
      <gz_frame_id>rover/body</gz_frame_id></sensor></link>
      <frame name='eye' attached_to='chassis'><pose>0 0 0.3 0 0 0</pose></frame><link name='mast'>
      <sensor name='front' type='gpu_lidar'><pose relative_to='eye'>0.1 0 0 0 0 0</pose>
      <plugin name='p'><frameName> eyes </frameName></plugin></sensor></link>
      <joint name='mast' type='fixed'><parent>chassis</parent><child>mast</child></joint>
      <link name='ball'><pose>-0.25 0 0.05 0 0 0</pose><inertial><mass>0.5</mass>
      <inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia></inertial>
      <collision name='c'><geometry><sphere><radius>0.05</radius></sphere></geometry></collision></link>
      <joint name='ball' type='ball'><parent>chassis</parent><child>ball</child></joint>{wheels}{more}
      <plugin name='drive' filename='gz-sim-diff-drive-system'><left_joint>left</left_joint>
      <right_joint>right</right_joint><wheel_separation>0.62</wheel_separation>
      <wheel_radius>0.15</wheel_radius></plugin></model></world></sdf>"""


def of_gazebo(folder: Path, text: str) -> Path:
    """The folder of a model, with the part that it includes beside it."""
    for name, content in (("rover", text), ("wheel", WHEEL)):
        (folder / name).mkdir()
        (folder / name / "model.sdf").write_text(content)
    return folder / "rover"


def test_what_is_included_and_what_sensors_and_plugins_say_counts(tmp_path: Path) -> None:
    arm = """<link name='arm'><pose>0.2 0 0.4 0 0 0</pose></link><link name='scanner'/>
      <joint name='scanner' type='revolute'><parent>scanner</parent><child>ball</child>
      <axis><limit><lower>0</lower><upper>-0.0</upper></limit></axis></joint>
      <joint name='arm' type='prismatic'><pose>0 0 0.1 0 0 0</pose>
      <parent>chassis</parent><child>arm</child><axis><xyz>0 0 1</xyz><limit><lower>0</lower>
      <upper>0.1</upper></limit><dynamics><spring_stiffness>500</spring_stiffness>
      <spring_reference>0.02</spring_reference></dynamics></axis></joint>
      <joint name='gear' type='gearbox'><parent>left::link</parent><child>right::link</child></joint>"""
    arm += "<link name='chassis_skid'/>" + JOINT.format("mast", "chassis_skid")
    arm += "<link name='eyes'><pose relative_to='eye'>0.1 0 0 0 0 0</pose></link>"
    arm += JOINT.format("chassis", "eyes").replace("'j'", "'e'")
    text = of_parts(arm).replace("</world>", f"{ANOTHER}</world>")
    text = re.sub("<inertial><mass>8.*?</inertial>", SKID, text).replace(
        "'rover'>", "'rover'><static>1</static>"
    )
    made = write_folder("rover", of_gazebo(tmp_path, text), tmp_path / "made")
    rover = made.rover
    model = read_model(rover).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert (rover.drive.left, rover.drive.right) == (("left",), ("right",))
    assert (rover.lidar_frame, rover.imu_frame) == ("eyes", "rover_body")
    assert (rover.casters, rover.controller_separation) == (("chassis_skid_", "ball"), 0.62)
    assert (rover.track, rover.wheelbase) == pytest.approx((0.6, 0.3))  # of one axle: two radii
    chassis = data.body("chassis").xpos
    assert data.site("lidar").xpos - chassis == pytest.approx([0.1, 0.0, 0.3])
    assert data.site("imu").xpos - chassis == pytest.approx([0.0, 0.05, 0.0])
    assert data.body("left_link").xpos - chassis == pytest.approx([0.2, 0.3, -0.1])
    assert (model.body("left_link").mass, model.body("mast").mass) == ([2.0], [0.0])
    assert model.actuator("left").forcerange == pytest.approx([-5.0, 5.0])
    assert model.actuator("left").ctrlrange == pytest.approx([-8.0, 8.0])
    assert model.joint("left").damping == pytest.approx([0.1])
    assert data.joint("arm").xanchor - chassis == pytest.approx([0.2, 0.0, 0.25])
    assert [model.body(name).mass for name in ("chassis", "arm")] == [[1.0], [1.0]]
    assert model.body("scanner").parentid == model.body("ball").id
    assert model.njnt == 4  # of all that is said to be a joint
    assert (model.joint("arm").stiffness, model.joint("arm").qpos_spring) == ([500.0], [0.02])
    assert any("shell.stl is not there" in note for note in made.notes)
    assert made.notes[:7] == (
        "link 'chassis' has no <inertial>, so 1 kg and 1 kg m^2, as in Gazebo",
        "visual 'cone' of link 'chassis': no shape here is a <cone>; dropped",
        "visual 'hood' of link 'chassis': a part of a mesh is not taken alone; dropped",
        "link 'arm' has no <inertial>, so 1 kg and 1 kg m^2, as in Gazebo",
        "joint 'ball' is a ball's; held, so that what it carries slides",
        "of several sensors for the lidar (cliff, front) it has front",
        (
            "without <inertial>, so no mass, where Gazebo takes 1 kg each: "
            "mast, scanner, chassis_skid, eyes"
        ),
    )


@pytest.mark.parametrize("outer", ["", "<link name='base'/>"])
@pytest.mark.parametrize("tied", ["", "attached_to='__model__'"])
def test_a_frame_of_a_merged_model_is_attached_to_the_link_of_that_model(
    outer: str, tied: str, tmp_path: Path
) -> None:
    part = f"""<link name='a'/><link name='b'/><frame name='mount' {tied}/>
      <joint name='j' type='revolute'><parent>mount</parent><child>b</child></joint>"""
    (tmp_path / "part").mkdir()
    (tmp_path / "part/model.sdf").write_text(f"<sdf version='1.9'><model name='p'>{part}</model></sdf>")
    include = f"<include merge='true'><uri>{tmp_path}/part</uri></include>"
    text = f"<sdf version='1.9'><model name='o'>{outer}{include}</model></sdf>"
    model = sdf_model.read_model(parse_xml(text.encode()), tmp_path / "o.sdf", (), "o")
    assert model.joints["j"].parent == "a"


@pytest.mark.parametrize(("stated", "whole"), [("", 1.0), ("<mass>7</mass>", 7.0 / 130.8)])
def test_inertia_is_that_of_the_shapes_where_it_is_left_to_gazebo(
    stated: str, whole: float, tmp_path: Path
) -> None:
    more = """<collision name='d'><density>100</density><pose degrees='true'>0.4 0 0 0 90 0</pose>
      <geometry><cylinder><radius>0.1</radius><length>{}</length></cylinder></geometry></collision>"""
    more = more.format(10.8 / math.pi)  # of 10.8 kg
    auto = f"<inertial auto='1'><density>2500</density>{stated}</inertial>{more}"
    text = re.sub("<inertial><mass>8.*?</inertial>", auto, of_parts())
    rover = write_folder("rover", of_gazebo(tmp_path, text), tmp_path / "made").rover
    model = read_model(rover).compile()
    mass, length, x = 120.0, 10.8 / math.pi, 0.4 * 10.8 / 130.8
    box, rod = mass / 12 * (0.4**2 + 0.2**2), 10.8 / 2 * 0.1**2
    along = [mass / 12 * (0.6**2 + b**2) + mass * x**2 for b in (0.2, 0.4)]
    across = 10.8 * (0.1**2 / 4 + length**2 / 12 + (0.4 - x) ** 2)
    inertia = [box + rod, *(one + across for one in along)]
    body = model.body("chassis")
    assert body.mass == pytest.approx([130.8 * whole])
    assert sorted(body.inertia) == pytest.approx(sorted(whole * one for one in inertia), rel=1e-5)
    assert body.ipos == pytest.approx([x, 0.0, 0.0], abs=NEAR)


@pytest.mark.parametrize("kind", ["universal", "revolute2"])
def test_a_joint_of_two_axes_is_two_joints_and_a_light_link_between_them(
    kind: str, tmp_path: Path
) -> None:
    text = of_parts(kind=kind)
    (roll, *_) = re.findall(r"<axis>.*?</axis>", text, re.DOTALL)
    steer = roll.replace("0 1 0", "0 0 1").replace("inf", "0.5")
    inertia = "<inertia><ixx>1e-5</ixx><iyy>1e-5</iyy><izz>1e-5</izz></inertia>"
    apart = f"""<link name='left_cross'><pose relative_to='left::link'/><inertial><mass>0.01</mass>
      {inertia}</inertial></link><joint name='left' type='revolute'><parent>chassis</parent>
      <child>left_cross</child>{steer}</joint><joint name='left_2' type='revolute'>
      <parent>left_cross</parent>"""
    texts = (
        text.replace(roll, steer + roll.replace("axis>", "axis2>"), 1),
        text.replace(f"<joint name='left' type='{kind}'><parent>chassis</parent>", apart),
    )
    made = list[Written]()
    for name, one in zip("ab", texts, strict=True):
        (tmp_path / name).mkdir()
        source = of_gazebo(tmp_path / name, one)
        made.append(write_folder("made", source, tmp_path / name / "made"))
    assert made[0].rover.wheel_joints == ("left_2", "right")
    models = [(one.rover.folder / "made.xml").read_text() for one in made]
    assert models[0] == models[1]


SKID = """<collision name='skid'><pose>0.25 0 -0.2 0 0 0</pose><geometry><sphere><radius>0.05</radius>
  </sphere></geometry></collision>"""
JOINT = "<joint name='j' type='fixed'><parent>{}</parent><child>{}</child></joint>"
ANOTHER = "<model name='b'><joint type='ball'/></model>"
MISTAKES = {
    "no rover": (
        "<sdf version='1.9'><model name='post'/></sdf>",
        "joints that move: post",
    ),
    "two": (
        of_parts().replace("</world>", f"{ANOTHER}</world>"),
        "rover, b; call",
    ),
    "a loop": (of_parts(JOINT.format("ball", "mast")), "link 'mast' hangs on joints 'mast' and 'j'"),
    "a ring": (
        of_parts(JOINT.format("mast", "chassis")),
        "links hang in a loop, mast -> chassis -> mast; take",
    ),
    "a link twice": (of_parts("<link name='mast'/>"), "two links are called 'mast'"),
    "a joint twice": (of_parts(JOINT.format("ball", "mast") * 2), "two joints are called 'j'"),
    "nothing": (of_parts(JOINT.format("ball", "bowl")), "frame 'bowl' does not exist"),
    "a part that is not there": (of_parts(part="left::rim"), "rim"),
    "universal": (of_parts(kind="universal"), "joint 'left' is 'universal' without an <axis2>; add it"),
    "screw": (of_parts(kind="screw"), "joint 'left' is 'screw'; valid: revolute, "),
    "auto of nothing": (
        of_parts("<link name='bar'><inertial auto='true'/></link>"),
        "link 'bar' leaves its inertia to shapes that weigh nothing",
    ),
    "a size": (of_parts().replace("0.6 0.4 0.2", "0.6 0.4"), "give 3 finite numbers"),
    "an effort": (of_parts().replace("<effort>5", "<effort>a"), "<effort> of a joint: 'a' is no number"),
    "a mass": (of_parts().replace("<mass>8", "<mass>heavy"), "a mass and an inertia in numbers"),
    "a mesh": (
        of_parts().replace("<box><size>0.6 0.4 0.2</size></box>", "<mesh><uri>a.stl</uri></mesh>"),
        "collision mesh a.stl is not there",
    ),
}


@pytest.mark.parametrize(("text", "told"), MISTAKES.values(), ids=MISTAKES)
def test_what_is_no_rover_is_told_in_one_line(text: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError) as raised:
        write_folder("made", of_gazebo(tmp_path, text), tmp_path / "made")
    assert told in str(raised.value)
    assert str(raised.value).count("model.sdf") == 1
    assert "\n" not in str(raised.value)
    assert not (tmp_path / "made").exists()
