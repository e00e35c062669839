"""URDFs as they are found in the wild become folders; what cannot be is told in one line."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest
import trimesh

from harness import robot as command
from harness.base.errors import UsageError
from harness.base.mesh import Mesh
from harness.robots import RoverSpec
from harness.robots.frames.rover_frames import rover_frames
from harness.robots.model import read_model
from harness.robots.reading import read_rover
from harness.robots.urdf.folder import Written, write_folder
from harness.run import main
from harness.sensors.choice import chosen
from harness.validate.checkup import check_up
from tests.harness.world.solids.shapes import write_dae
from tests.support.complaint import complaint
from tests.support.foreign_rovers import (
    BUGGY,
    HUSKY,
    LEO_LIKE,
    ROVER_4WD_LIKE,
    joint,
    link,
    wheel,
)
from tests.support.snapshots import check_snapshot


def written(folder: Path, urdf: str, **sides: tuple[str, ...]) -> Written:
    (folder / "robot.urdf").write_text(urdf)
    return write_folder("made", folder / "robot.urdf", folder / "made", **sides)  # type: ignore[arg-type]  # left, right


def test_a_rover_built_as_leo_is(tmp_path: Path) -> None:
    """Rockers with a mimic, frames turned by pi, meshes of a package of which some are missing."""
    meshes = tmp_path / "leo_description" / "models"
    meshes.mkdir(parents=True)
    trimesh.creation.box((0.31, 0.28, 0.1)).export(meshes / "Chassis_outline.stl")
    made = written(tmp_path, LEO_LIKE)
    meshes.rename(tmp_path / "gone")  # the folder has meshes of its own
    assert made.notes == tuple(
        f"link '{link}': visual mesh package://leo_description/models/{mesh} is not there; dropped"
        for link, mesh in (("base_link", "Chassis.dae"), ("antenna_link", "Antenna.dae"))
    )
    rover, model = made.rover, read_model(made.rover).compile()
    assert (rover.drive.left, rover.drive.right) == (
        ("wheel_FL_joint", "wheel_RL_joint"),
        ("wheel_FR_joint", "wheel_RR_joint"),
    )
    assert rover.passive_joints == ("rocker_L_joint", "rocker_R_joint")
    assert rover.imu_frame == "imu_frame"
    assert rover.odometry_child_frame == "base_footprint"
    assert rover.wheelbase == pytest.approx(0.30512)
    assert model.neq == 1
    assert rover.lidar_x == pytest.approx(0.174)
    frames = {link.name: link.in_base[:3, 3] for link in rover_frames(rover).links}
    assert frames["lidar_link"] == pytest.approx((0.174, 0.0, 0.79783))
    assert {"base_link", "wheel_FL_link", "imu_frame", "antenna_link"} <= frames.keys()


def test_a_rover_built_as_rover_4wd_is(tmp_path: Path) -> None:
    """Wheel joints with axes of z in turned links, limits on effort and speed, no lidar."""
    made = written(tmp_path, ROVER_4WD_LIKE)
    assert made.rover.drive.left == ("fl_wheel_to_chassis", "rl_wheel_to_chassis")
    assert made.rover.wheel_speed_limit == 10.0
    model = read_model(made.rover).compile()
    motors = model.actuator_forcerange[:, 1]
    assert motors.tolist() == [20.0] * 4
    assert any(guess.startswith("lidar: ") for guess in made.guesses)
    assert made.notes == (
        "joint 'fr_wheel_to_chassis': its axis pointed backwards; turned",
        "joint 'rr_wheel_to_chassis': its axis pointed backwards; turned",
    )


LIMIT = 'effort="40" velocity="6.06"'
VARIANTS = {
    "stated": (LIMIT, True, True),
    "none": ("", False, False),
    "too large to be one": ('effort="1e6" velocity="1e6"', False, False),
    "faster than rovers": ('effort="40" velocity="100"', True, False),
    "nonsense": ('effort="-1" velocity="x"', False, False),
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_wheels_have_the_stated_motors_or_those_that_spin_them(variant: str, tmp_path: Path) -> None:
    """Else that of friction 1 and the axle's, and 1 m/s; all torque 5 % behind the top speed."""
    limit, strength_stated, speed_stated = VARIANTS[variant]
    lossy = HUSKY.urdf.replace(AXIS, f'{AXIS}<dynamics damping="0.2" friction="0.3"/>')
    made = written(tmp_path, lossy.replace(LIMIT, limit))
    model, radius, mass = read_model(made.rover).compile(), HUSKY.wheel_radius, HUSKY.mass
    fastest = 6.06 if speed_stated else round(1.0 / radius, 2)
    torque = 40.0 if strength_stated else round(mass * 9.81 * radius / 4 + 0.2 * fastest + 0.3, 3)
    for name in HUSKY.left + HUSKY.right:
        motor, joint = model.actuator(name), model.joint(name)
        assert motor.ctrlrange == pytest.approx((-fastest, fastest))
        assert motor.forcerange == pytest.approx((-torque, torque))
        assert motor.gainprm[0] == pytest.approx(torque / (0.05 * fastest), rel=1e-5)
        assert model.dof_armature[joint.dofadr[0]] == pytest.approx(0.2 * mass / 4 * radius**2)
        assert not model.jnt_actfrclimited[joint.id]
    guesses = [guess.partition(";")[0] for guess in made.guesses if "wheel " in guess]
    spins = f"model: wheel torque: {torque:g} N m each, which spins the wheels"
    runs = f"model: wheel speed: {fastest:g} rad/s, 1 m/s"
    assert guesses == [spins] * (not strength_stated) + [runs] * (not speed_stated)
    assert model.body_mass.sum() == pytest.approx(mass)
    solid = model.geom_contype > 0
    tyres = solid & (model.geom_type == mujoco.mjtGeom.mjGEOM_ELLIPSOID)
    assert model.geom_priority[solid].tolist() == [1] * solid.sum()
    assert model.geom_friction[tyres].tolist() == [[1.0, 0.005, 0.0001]] * 4
    assert model.geom_friction[solid & ~tyres].tolist() == [[0.3, 0.005, 0.0001]]
    assert model.geom_solimp[tyres][0].tolist() == [0.15, 0.95, 0.002, 0.5, 2.0]
    seen = ~solid & (model.geom_type == mujoco.mjtGeom.mjGEOM_CYLINDER)
    assert model.geom_rgba[seen] == pytest.approx(np.array([[0.07, 0.07, 0.075, 1.0]] * 4))
    assert (model.opt.cone, model.opt.timestep) == (mujoco.mjtCone.mjCONE_ELLIPTIC, 0.0025)
    assert model.opt.gravity.tolist() == [0.0, 0.0, -9.81]
    assert {model.site(name).group[0] for name in ("lidar", "imu")} == {4}


@pytest.mark.parametrize(("axis", "velocity"), [("0 0 1", "3.2"), ("0 0 -1", "1e6")])
def test_steering_has_the_stated_range_as_seen_from_above(
    axis: str, velocity: str, tmp_path: Path
) -> None:
    """Servos turn the wheels of a car that stands; an axis that points down is turned with its range."""
    urdf = BUGGY.urdf.replace('lower="-0.4189" upper="0.4189"', 'lower="-0.4" upper="0.3"')
    urdf = urdf.replace('<axis xyz="0 0 1"/>', f'<axis xyz="{axis}"/>')
    urdf = urdf.replace('velocity="3.2"', 'velocity="4.1"', 1)  # one of the two is faster
    made = written(tmp_path, urdf.replace('velocity="3.2"', f'velocity="{velocity}"'))
    model, rover = read_model(made.rover).compile(), made.rover
    ends = (-0.4, 0.3) if axis == "0 0 1" else (-0.3, 0.4)
    effort = 3.74 * 9.81 * 0.0508
    assert rover.drive.steering == ("left_steering", "right_steering")
    for name in rover.drive.steering:
        joint, motor = model.joint(name), model.actuator(name)
        assert joint.axis.tolist() == [0.0, 0.0, 1.0]
        assert joint.range == pytest.approx(ends)
        assert motor.ctrlrange == pytest.approx(ends)
        assert motor.forcerange == pytest.approx((-effort, effort))
        assert (motor.gainprm[0], motor.biasprm[2]) == pytest.approx((10 * effort, -effort))
        assert model.dof_armature[joint.dofadr[0]] == pytest.approx(0.2 * 3.74 / 4 * 0.0508**2)
    assert rover.drive.steering_rate == (3.2 if velocity == "3.2" else 2.0)
    assert ("drive: steering_rate 2 rad/s" in made.guesses) == (velocity == "1e6")
    assert len([note for note in made.notes if "pointed backwards" in note]) == 2 * (axis != "0 0 1")


@pytest.mark.parametrize("sensor", ["LIDAR", "front_laser", "hokuyo_1"])
def test_sensors_are_found_by_the_names_of_their_links(sensor: str, tmp_path: Path) -> None:
    urdf = HUSKY.urdf.replace('"laser"', f'"{sensor}"').replace('"imu_link"', '"my_IMU"')
    rover = written(tmp_path, urdf).rover
    assert rover.lidar_x == pytest.approx(0.3)
    assert (rover.imu_frame, rover.lidar_frame) == ("my_IMU", sensor)
    assert next(row for row in chosen(rover, ()) if row.fault == "scan").frame_on(rover) == sensor


def test_the_written_file_says_what_is_stated_derived_and_guessed(tmp_path: Path) -> None:
    """A car of guesses; and a height at rest that is 0 but for the arithmetic."""
    urdf = re.sub(r"<limit[^>]*/>", "", BUGGY.urdf.replace("revolute", "continuous"))
    urdf = urdf.replace("</robot>", "<plugin><wheelSeparation>0.3</wheelSeparation></plugin></robot>")
    written(tmp_path, urdf)
    text = (tmp_path / "made" / "rover.yaml").read_text()
    (tmp_path / "two").mkdir()
    lifted = joint("b", "fixed", "base", "chassis", (0, 0, 0.0508 - 2.3e-7)) + link("base", 0.0)
    written(tmp_path / "two", BUGGY.urdf.replace("</robot>", f"{lifted}</robot>"))
    check_snapshot("rover.yaml.txt", text + (tmp_path / "two" / "made" / "rover.yaml").read_text())


def test_a_limited_hinge_that_reaches_the_ground_is_no_wheel(tmp_path: Path) -> None:
    arm = wheel("arm", "base_link", (0.0, 0.4, 0.0328), 0.1651, 0.05, 1.0)
    arm = arm.replace("continuous", "revolute").replace(
        '<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
    )
    arm += '<transmission name="a"><joint name="arm_joint"/></transmission>'
    made = written(tmp_path, HUSKY.urdf.replace("</robot>", f"{arm}</robot>"))
    assert made.rover.drive.left == HUSKY.left
    assert made.rover.drive.driven == made.rover.wheel_joints
    assert any("motors" in guess and guess.endswith(": arm_joint") for guess in made.guesses)
    assert made.rover.passive_joints == ("arm_joint",)


def test_wheels_that_trail_what_swivels_are_casters_and_limits_of_many_turns_are_none(
    tmp_path: Path,
) -> None:
    free = BUGGY.urdf.replace('lower="-0.4189" upper="0.4189"', "").replace("revolute", "continuous")
    trailing = re.sub(r'(child link="front_\w+"/><origin xyz=")0.0', r"\1-0.03", free)
    limits = '<limit lower="-1e16" upper="1e16" effort="1.5"'
    trailing = trailing.replace('<limit effort="1.5"', limits)
    rover = written(tmp_path, trailing).rover
    assert (rover.drive.kind, rover.wheel_joints) == ("skid", ("rear_left_joint", "rear_right_joint"))
    assert_carried_by_casters(rover)
    all_round = BUGGY.urdf.replace("0.4189", "3.1416")  # as tutorials have it
    for name, steered in (("free", free), ("round", all_round)):
        (tmp_path / name).mkdir()
        drive = written(tmp_path / name, steered).rover.drive
        assert (drive.kind, drive.steering_limit) == ("ackermann", 0.5)


def assert_carried_by_casters(rover: RoverSpec) -> None:
    """It stands and turns on them, and that is no scraping."""
    odd = [check.quantity for check in check_up(rover) if not check.passed]
    assert not [quantity for quantity in odd if "on the ground" in quantity or "tip angle" in quantity]


def test_what_slides_beside_the_wheels_of_one_axle_is_a_caster(tmp_path: Path) -> None:
    front, rest = re.subn(r'(name="front_\w+" type=")continuous', r"\1fixed", HUSKY.urdf)
    assert rest == 2
    rover = written(tmp_path, front).rover
    assert rover.wheel_joints == ("rear_left_wheel_joint", "rear_right_wheel_joint")
    assert_carried_by_casters(rover)
    # Contacts with the ground are looked at while something else is touched: one runs into the other.
    two = ["--rover", f"{rover.folder}:a,driver=spin", "--rover", f"{rover.folder}:b,x=-1.1,y=0"]
    words = ["--driver", "straight", "--terrain", "flat", "--duration", "1", "--direct"]
    assert main([*two, *words, "--log-dir", str(tmp_path / "logs")]) == 0
    truths = [json.loads(file.read_text())["truth"] for file in tmp_path.glob("logs/*/*.json")]
    assert [(truth["hazard_contacts"], truth["scrapes"]) for truth in truths] == [(1, 0), (1, 0)]


def test_four_steered_wheels_are_held_straight(tmp_path: Path) -> None:
    urdf = BUGGY.urdf
    for side in ("left", "right"):
        old = f'<parent link="chassis"/><child link="rear_{side}"/>'
        assert old in urdf
        urdf = urdf.replace(old, f'<parent link="{side}_rear_hinge"/><child link="rear_{side}"/>')
        y = 0.12065 if side == "left" else -0.12065
        where = f'<origin xyz="-0.17145 {y} 0.0"/>'
        urdf = urdf.replace(where, '<origin xyz="0 0 0"/>')
        axis = '<axis xyz="0 0 -1"/><limit lower="-0.4" upper="0.3" effort="5" velocity="3"/>'
        place = (-0.17145, y, 0.0)
        hinge = link(f"{side}_rear_hinge", 0.05, "", (0.03, 0.03, 0.03))
        axis += '<dynamics spring_stiffness="5" spring_reference="0.1"/>'  # as of SDF
        hinge += joint(f"{side}_rear", "revolute", "chassis", f"{side}_rear_hinge", place, axis)
        urdf = urdf.replace("</robot>", f"{hinge}</robot>")
    made = written(tmp_path, urdf)
    assert made.rover.drive.kind == "skid"
    model = read_model(made.rover).compile()
    for side in ("left", "right"):  # in the order of their names, the rear axes turned
        assert model.joint(f"{side}_rear").axis.tolist() == [0.0, 0.0, 1.0]
        assert model.actuator(f"{side}_rear").ctrlrange == pytest.approx((-0.3, 0.4))
        assert model.joint(f"{side}_rear").qpos_spring == pytest.approx([-0.1])
    assert sum(note.endswith("its axis pointed backwards; turned") for note in made.notes) == 2
    assert len([note for note in made.notes if note.endswith("steers; held straight")]) == 4


@pytest.mark.parametrize(
    ("tags", "believed"),
    [
        ("<wheel_separation>1.1</wheel_separation><wheel_diameter>0.3</wheel_diameter>", (1.1, 0.15)),
        ("<wheelSeparation>1.1</wheelSeparation><wheelDiameter>0.3</wheelDiameter>", (1.1, 0.15)),
        ("<wheel_radius>0.2</wheel_radius><wheel_diameter>0.3</wheel_diameter>", (0.5708, 0.2)),
        ("<wheelRadius/><wheelRadius>0</wheelRadius><wheelRadius>0.2</wheelRadius>", (0.5708, 0.2)),
    ],
)
def test_a_controllers_plugin_tells_what_it_believes(
    tags: str, believed: tuple[float, float], tmp_path: Path
) -> None:
    """And ros2_control which wheels have motors; nothing of what holds no other joint."""
    command = '<joint name="{}_wheel_joint"><command_interface name="velocity"/></joint>'
    control = "".join(map(command.format, ("rear_left", "rear_right")))
    control += '<joint name="front_left_wheel_joint"><state_interface name="velocity"/></joint>'
    more = f"<gazebo><plugin>{tags}</plugin></gazebo><ros2_control>{control}</ros2_control>"
    made = written(tmp_path, HUSKY.urdf.replace("</robot>", f"{more}</robot>"))
    rover = made.rover
    assert (rover.controller_separation, rover.controller_radius) == pytest.approx(believed)
    assert any(f"takes its wheels for {believed[1]:g} m" in note for note in made.notes)
    assert rover.drive.driven == ("rear_left_wheel_joint", "rear_right_wheel_joint")


def test_meshes_that_cannot_be_had_are_noted_and_those_of_other_folders_are_named(
    tmp_path: Path,
) -> None:
    """Two meshes of one name from elsewhere; a visual of another format; a joint that nothing moves."""
    for folder in ("one", "two"):
        (tmp_path / "there" / folder).mkdir(parents=True)
        trimesh.creation.box((0.3, 0.2, 0.1)).export(tmp_path / "there" / folder / "a.stl")
    (here := tmp_path / "here").mkdir()
    (here / "a.glb").touch()
    mesh = '<{0}><geometry><mesh filename="{1}"/></geometry></{0}>'
    meshes = mesh.format("collision", "package://one/a.stl") + mesh.format("collision", "two/a.stl")
    meshes += mesh.format("visual", "a.glb")
    arm = link("arm", 1.0, "", (0.1, 0.1, 0.1)) + joint(
        "arm", "continuous", "base_link", "arm", (0, 0, 1)
    )
    urdf = HUSKY.urdf.replace('<link name="base_link">', f'<link name="base_link">{meshes}', 1)
    (here / "robot.urdf").write_text(urdf.replace("</robot>", f"{arm}</robot>"))
    with pytest.raises(UsageError, match=r"package://one/a\.stl is not there; put its package"):
        write_folder("made", here / "robot.urdf", tmp_path / "no")
    words = ["new", "made", "--from", str(here / "robot.urdf"), "--out", str(tmp_path / "new" / "made")]
    assert command.main([*words, "--resource-path", str(tmp_path / "there")]) == 0
    kept = sorted(path.name for path in (tmp_path / "new" / "made" / "meshes").iterdir())
    assert kept == ["0_a.stl", "1_a.stl"]
    again = write_folder("made", here / "robot.urdf", tmp_path / "b", folders=(tmp_path / "there",))
    assert again.notes == (
        "link 'base_link': visual mesh a.glb is no .dae, .obj, .stl, .ply or .msh; dropped",
        "joint 'arm' has no motor and moves freely",
    )
    assert 'model="made"' in (tmp_path / "b" / "made.xml").read_text()


@pytest.mark.parametrize("form", ["stl", "stl_ascii", "STL_ASCII", "dae", "ply"])
def test_a_wheel_of_a_mesh_that_is_not_closed_is_as_large_as_its_corners(
    form: str, tmp_path: Path
) -> None:
    """As scans and exports are; the principal axes, along which MuJoCo lays a mesh's box, lean then.

    COLLADA is read as RViz and Gazebo read it: by its unit, whatever axis it says is up.
    """
    radius, width = HUSKY.wheel_radius, 0.1143
    tyre = trimesh.creation.cylinder(radius, width, sections=48)
    tyre.update_faces(np.arange(len(tyre.faces)) % 9 > 0)
    name = f"tyre.{form.lower().removesuffix('_ascii')}"
    if form == "dae":
        inches = Mesh(tyre.vertices / 0.0254, tyre.faces)
        write_dae(tmp_path / name, inches, "<unit meter='0.0254'/><up_axis>Y_UP</up_axis>")
    else:
        tyre.export(tmp_path / name, file_type=form.lower())
    if form.isupper():  # as some programs write it
        (tmp_path / name).write_text((tmp_path / name).read_text().upper())
    cylinder = f'<cylinder radius="{radius}" length="{width}"/>'
    rover = written(tmp_path, HUSKY.urdf.replace(cylinder, f'<mesh filename="{name}"/>')).rover
    assert rover.controller_radius == pytest.approx(radius, rel=1e-4)
    assert (rover.track, rover.wheelbase) == pytest.approx((HUSKY.track, HUSKY.wheelbase), rel=1e-4)


def test_an_inertia_that_no_body_can_have_is_balanced_and_told(tmp_path: Path) -> None:
    thin = '<mass value="{}"/><inertia ixx="0.1" iyy="0.2" izz="{}" ixy="0" ixz="0" iyz="0"/>'
    parts = "".join(
        f'<link name="{name}"><inertial>{thin.format(1, izz)}</inertial></link>'
        + joint(f"{name}_mount", "fixed", "base_link", name, (0, 0, 0.5))
        for name, izz in (("odd", 0.31), ("flat", 0.3))
    )
    made = written(tmp_path, HUSKY.urdf.replace("</robot>", f"{parts}</robot>"))
    assert made.notes == ("link 'odd': no body has the inertia [0.1, 0.2, 0.31]; balanced",)


def test_a_wheel_that_is_named_rolls_on_beyond_the_limits_of_its_joint(tmp_path: Path) -> None:
    urdf = HUSKY.urdf.replace("continuous", "revolute").replace(LIMIT, f'lower="-9" upper="9" {LIMIT}')
    made = written(tmp_path, urdf, left=HUSKY.left, right=HUSKY.right)
    model = read_model(made.rover).compile()
    assert not any(model.jnt_limited[model.joint(name).id] for name in HUSKY.left + HUSKY.right)
    assert sum("rolls on" in note for note in made.notes) == 4


@pytest.mark.parametrize("backwards", [HUSKY.left, HUSKY.left[:1], HUSKY.right[1:]])
def test_wheels_that_mimic_others_turn_as_these_do_whichever_way_their_axes_point(
    backwards: tuple[str, ...], tmp_path: Path
) -> None:
    tree = ET.fromstring(HUSKY.urdf)  # noqa: S314 - it is ours
    for hinge in tree.iter("joint"):
        if (name := hinge.attrib["name"]) in backwards:
            hinge.find("axis").attrib["xyz"] = "0 -1 0"  # type: ignore[union-attr]  # of a wheel
        if name.startswith("rear"):
            front = name.replace("rear", "front")
            sign = "1" if (name in backwards) == (front in backwards) else "-1"
            ET.SubElement(hinge, "mimic", joint=front, multiplier=sign)
    model = read_model(written(tmp_path, ET.tostring(tree, "unicode")).rover).compile()
    assert model.eq_data[:, :5].tolist() == [[0.0, 1.0, 0.0, 0.0, 0.0]] * 2


NAMESPACE = ' xmlns:xacro="http://www.ros.org/wiki/xacro"><!-- <xacro:include filename="${a}"/> -->'
NO_MASS = '<link name="zero"><inertial><mass value="0"/><inertia ixx="0"/></inertial></link>'
FIXED = '<joint name="to" type="fixed"><parent link="base_link"/><child link="zero"/></joint></robot>'


@pytest.mark.parametrize(
    ("old", "left_behind"),
    [
        ('">', f'"{NAMESPACE}'),
        ("<robot", '\n<!-- by hand -->\n<?xml version="1.0"?><robot'),
        ("</robot>", NO_MASS + FIXED),
    ],
    ids=["xacro's namespace and comments", "a late declaration", "a frame with a mass of 0"],
)
def test_what_tools_that_write_urdf_leave_behind_does_not_count(
    old: str, left_behind: str, tmp_path: Path
) -> None:
    rover = written(tmp_path, HUSKY.urdf.replace(old, left_behind, 1)).rover
    assert rover.wheel_joints == HUSKY.left + HUSKY.right
    assert read_model(rover).compile().body_mass.sum() == pytest.approx(HUSKY.mass)


def test_wheels_may_be_named(tmp_path: Path) -> None:
    sides = {"left": ("rear_left_wheel_joint",), "right": ("rear_right_wheel_joint",)}
    assert written(tmp_path, HUSKY.urdf, **sides).rover.wheel_joints == (*sides["left"], *sides["right"])


def test_wheels_of_unequal_size_are_told(tmp_path: Path) -> None:
    smaller = HUSKY.urdf.replace('radius="0.1651"', 'radius="0.15"', 1)
    assert any("wheels of 0.15 to 0.165 m" in note for note in written(tmp_path, smaller).notes)


def with_mesh(file: str) -> str:
    mesh = f'<collision><geometry><mesh filename="package://p/{file}"/></geometry></collision>'
    return HUSKY.urdf.replace("<collision>", f"{mesh}<collision>", 1)


def of_wheel(old: str, new: str) -> str:
    return HUSKY.urdf.replace(old, new, 1)


MASS, AXIS = 'mass value="2.637"', '<axis xyz="0 1 0"/>'
MISTAKES = {
    "not XML": ("<robot", "is not XML"),
    "not URDF": ("<mujoco/>", "is neither URDF nor SDF: it holds <mujoco>"),
    "empty": ("<robot/>", "holds no <link>"),
    "entities": ('<!DOCTYPE r [<!ENTITY a "b">]><robot/>', "declares a document type or entities"),
    "no wheels": (HUSKY.urdf.replace("continuous", "fixed"), "hinges: none; tracks are rows of wheels"),
    "bare wheels": (
        re.sub(r"<collision>.*?</collision>", "", HUSKY.urdf),
        "; without a <collision>, so no wheels: front_left_wheel_joint, ",
    ),
    "x to the side": (
        HUSKY.urdf.replace('<axis xyz="0 1 0"/>', '<axis xyz="1 0 0"/>'),
        "; about x, which must point ahead: front_left_wheel_joint, ",
    ),
    "zero mass": (of_wheel(MASS, 'mass value="0"'), "link 'front_left_wheel' has mass 0"),
    "no inertia": (of_wheel('ixx="', 'ixx="-'), "give numbers above 0"),
    "no number": (of_wheel(MASS, 'mass value="x"'), "a mass and an inertia in numbers"),
    "damping": (
        of_wheel(AXIS, f'{AXIS}<dynamics damping="-5"/>'),
        "damping -5 of joint 'front_left_wheel_joint' is not valid; give 0 to",
    ),
    "a mass": (of_wheel(MASS, 'mass value="1e30"'), "mass 1e+30 kg of body 'front_left_wheel'"),
    "endless": (HUSKY.urdf + " " * 20_000_000, "larger than 20,000,000 bytes"),
    "no mesh": (with_mesh("b.stl"), "collision mesh package://p/b.stl is not there"),
    "a mesh elsewhere": (
        with_mesh("../../b.stl"),
        "is outside of the URDF's folder; name its folder by --resource-path",
    ),
    "millimetres": (HUSKY.urdf.replace('radius="0.1651"', 'radius="165.1"'), "URDF is in metres"),
    "a body in millimetres": (HUSKY.urdf.replace('"0.9874', '"987.4'), "URDF is in metres"),
    "a mimic of nobody": (
        of_wheel(AXIS, f'{AXIS}<mimic joint="a"/>'),
        "mimics 'a', which is not there; take <mimic> out",
    ),
    "one more on a side": (
        HUSKY.urdf.replace("front_left_wheel_joint", "a").replace('"continuous"', '"fixed"', 1),
        "name as many on either side",
    ),
    "DAE": (with_mesh("a.dae"), "p/a.dae is not XML: no element found"),
    "no STL": (with_mesh("a.stl"), "a.stl is only Git LFS's pointer to it; git lfs pull fetches it"),
    "half an STL": (with_mesh("c.stl"), "c.stl is damaged or cut short; export it anew"),
    "half an STL in text": (with_mesh("d.stl"), "d.stl is damaged or cut short; export it anew"),
    "a floating root": (
        of_wheel('type="continuous"', 'type="floating"'),
        "is floating; take it and all above it out",
    ),
    "two links of a name": (
        HUSKY.urdf.replace("front_left_wheel", "rear_left_wheel"),
        "2 links are called 'rear_left_wheel'",
    ),
    "two joints of a name": (
        HUSKY.urdf.replace("front_left_wheel_joint", "rear_left_wheel_joint"),
        "2 joints are called 'rear_left_wheel_joint'",
    ),
}


@pytest.mark.parametrize(("urdf", "told"), MISTAKES.values(), ids=MISTAKES)
def test_a_urdf_that_is_no_rover_is_reported_in_one_line(urdf: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "b.stl").touch()
    (folder := tmp_path / "p" / "q").mkdir(parents=True)
    (folder / "a.dae").touch()
    (folder / "c.stl").write_bytes(bytes(80) + (12).to_bytes(4, "little") + bytes(50))
    (folder / "d.stl").write_text("solid d\n facet normal 0 0 1\n")
    (folder / "a.stl").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n")
    with pytest.raises(UsageError) as error:
        written(folder, urdf)
    assert told in str(error.value)
    assert "\n" not in str(error.value)
    assert not list(folder.glob("*made*"))  # no half a folder stays


def test_xacro_is_not_evaluated_unless_it_is_trusted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    evil = '<robot xmlns:xacro="x"><xacro:property name="a" value="${open(\'owned\', \'w\')}"/></robot>'
    file = tmp_path / "robot.urdf"
    file.write_text(evil)
    out = str(tmp_path / "made")
    told = complaint(command.main, ["new", "made", "--from", str(file), "--out", out], capsys)
    assert "which runs its author's Python" in told
    assert "--trust-xacro" in told
    assert list(tmp_path.iterdir()) == [file]


def test_xacro_that_is_trusted_becomes_the_rover_of_its_urdf(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc", reason="needs the extra [xacro]: make setup")
    plain = written(tmp_path, ROVER_4WD_LIKE).rover
    (tmp_path / "two").mkdir()
    limits = ROVER_4WD_LIKE.count('velocity="10"')
    assert limits == 4
    head = '<robot name="r" xmlns:xacro="x"><xacro:property name="w" value="${2 * 6.0}"/>'
    text = re.sub("<robot[^>]*>", head, ROVER_4WD_LIKE).replace('velocity="10"', 'velocity="${w}"')
    file = tmp_path / "two" / "robot.xacro"
    file.write_text(text)
    out = file.parent / "made"
    assert command.main(["new", "made", "--from", str(file), "--out", str(out), "--trust-xacro"]) == 0
    made = read_rover(out)
    assert made.wheel_speed_limit == 12.0
    assert (made.drive, made.footprint) == (plain.drive, plain.footprint)
    file.write_text(text.replace("2 * 6.0", "2 * six"))
    with pytest.raises(UsageError, match=r"^xacro refuses .*robot\.xacro: .*six"):
        write_folder("again", file, file.parent / "again", trust_xacro=True)


@pytest.mark.parametrize("of", ["", "$(find a_description)/urdf/", "$(find b_description)/urdf/"])
def test_xacro_finds_what_it_includes_beside_it_and_in_packages(tmp_path: Path, of: str) -> None:
    pytest.importorskip("xacrodoc", reason="needs the extra [xacro]: make setup")
    plain = written(tmp_path, ROVER_4WD_LIKE).rover
    for name in ("a", "b"):
        package = tmp_path / "src" / f"{name}_description"
        (package / "urdf").mkdir(parents=True)
        about = f"<package format='3'><name>{package.name}</name></package>"
        (package / "package.xml").write_text(about)
        (package / "urdf" / "all.xacro").write_text(ROVER_4WD_LIKE)
        farther = tmp_path / package.name  # of the same name, where anybody may have put it
        (farther / "urdf").mkdir(parents=True)
        (farther / "package.xml").write_text(about)
        (farther / "urdf" / "all.xacro").write_text("<robot>${of_a_stranger}</robot>")
    file = tmp_path / "src/a_description/urdf/robot.urdf.xacro"
    include = f'<xacro:include filename="{of}all.xacro"/>'
    file.write_text(f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{include}</robot>')
    out = tmp_path / "expanded"
    write_folder("expanded", file, out, trust_xacro=True)
    assert read_rover(out).drive == plain.drive
    file.write_text(file.read_text().replace(of or "all", "$(find nobodys)/all"))
    with pytest.raises(UsageError, match="not found; name the folder that holds it by --resource-path"):
        write_folder("again", file, tmp_path / "again", trust_xacro=True)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["../x", "--from", "robot.urdf"], "name '../x' is not valid"),
        (["made", "--from", "/dev/zero"], "/dev/zero: this is not a file but a device"),
        (["made", "--from", "none.urdf"], "cannot read none.urdf: No such file"),
        (["made", "--from", "robot.urdf", "--left", "a", "--right", "b"], "hinge 'a' does not exist"),
        (["made", "--from", "robot.urdf", "--out", "."], "exists already, not overwriting"),
    ],
)
def test_wrong_arguments_are_one_line(
    words: list[str],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("robot.urdf").write_text(BUGGY.urdf)
    assert told in complaint(command.main, ["new", *words], capsys)


def test_the_command_says_what_it_did_and_what_comes_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("robot.urdf").write_text(BUGGY.urdf)
    assert command.main(["new", "mine", "--from", "robot.urdf"]) == 0
    told = capsys.readouterr().out
    assert "guess: lidar: no link is called so" in told
    assert (
        "mine: 3.7 kg, 4 wheels, Ackermann steering; track 0.241 m, wheelbase 0.33 m, 5.08 m/s" in told
    )
    assert told.endswith("python -m harness.robot check mine; then python -m harness.run --robot mine\n")
