"""URDFs as they are found in the wild become folders; what cannot be is told in one line."""

import re
from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest
import trimesh

from harness import robot as command
from harness.base.errors import UsageError
from harness.frames.rover_frames import rover_frames
from harness.robots import RoverSpec, read_rover
from harness.robots.model import read_model
from harness.robots.urdf.folder import Written, write_folder
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

Foreign = Callable[[str], RoverSpec]


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


def test_what_the_urdf_says_is_kept_and_what_it_does_not_is_marked_as_a_guess(foreign: Foreign) -> None:
    model = read_model(foreign("husky")).compile()
    assert model.body_mass.sum() == pytest.approx(HUSKY.mass)
    wheels = model.geom_type == mujoco.mjtGeom.mjGEOM_ELLIPSOID
    assert model.geom_priority[wheels].tolist() == [1] * 4
    said = (foreign("buggy").folder / "rover.yaml").read_text()
    assert "# guess, lidar: no link is called so; 5 cm over the highest point" in said
    assert "# guess in the model, tyres" in said
    assert "# encoder_ticks: 4096  # guess" in said


def test_a_joint_whose_axis_points_backwards_is_turned_with_its_range(tmp_path: Path) -> None:
    urdf = BUGGY.urdf.replace('lower="-0.4189" upper="0.4189"', 'lower="-0.4" upper="0.3"')
    urdf = urdf.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 -1"/>')
    made = written(tmp_path, urdf)
    model = read_model(made.rover).compile()
    assert made.rover.drive.steering == ("left_steering", "right_steering")
    for name in made.rover.drive.steering:
        assert model.joint(name).axis.tolist() == [0.0, 0.0, 1.0]
        assert model.joint(name).range == pytest.approx((-0.3, 0.4))
        assert model.actuator(name).ctrlrange == pytest.approx((-0.3, 0.4))
    assert len([note for note in made.notes if "pointed backwards" in note]) == 2


def test_a_limited_hinge_that_reaches_the_ground_is_no_wheel(tmp_path: Path) -> None:
    arm = wheel("arm", "base_link", (0.0, 0.4, 0.0328), 0.1651, 0.05, 1.0)
    arm = arm.replace("continuous", "revolute").replace(
        '<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
    )
    made = written(tmp_path, HUSKY.urdf.replace("</robot>", f"{arm}</robot>"))
    assert made.rover.drive.left == HUSKY.left
    assert made.rover.passive_joints == ("arm_joint",)


def test_four_steered_wheels_are_held_straight(tmp_path: Path) -> None:
    urdf = BUGGY.urdf
    for side in ("left", "right"):
        old = f'<parent link="chassis"/><child link="rear_{side}"/>'
        assert old in urdf
        urdf = urdf.replace(old, f'<parent link="{side}_rear_hinge"/><child link="rear_{side}"/>')
        y = 0.12065 if side == "left" else -0.12065
        where = f'<origin xyz="-0.17145 {y} 0.0"/>'
        urdf = urdf.replace(where, '<origin xyz="0 0 0"/>')
        axis = '<axis xyz="0 0 1"/><limit lower="-0.4" upper="0.4" effort="5" velocity="3"/>'
        place = (-0.17145, y, 0.0)
        hinge = link(f"{side}_rear_hinge", 0.05, "", (0.03, 0.03, 0.03))
        hinge += joint(f"{side}_rear", "revolute", "chassis", f"{side}_rear_hinge", place, axis)
        urdf = urdf.replace("</robot>", f"{hinge}</robot>")
    made = written(tmp_path, urdf)
    assert made.rover.drive.kind == "skid"
    assert len([note for note in made.notes if note.endswith("steers; held straight")]) == 4


def test_a_controllers_plugin_tells_what_it_believes(tmp_path: Path) -> None:
    plugin = (
        "<gazebo><plugin><wheel_separation>1.1</wheel_separation><wheel_diameter>0.3</wheel_diameter>"
    )
    rover = written(
        tmp_path, HUSKY.urdf.replace("</robot>", plugin + "</plugin></gazebo></robot>")
    ).rover
    assert (rover.controller_separation, rover.controller_radius) == (1.1, 0.15)


def test_a_link_without_an_inertia_weighs_nothing(tmp_path: Path) -> None:
    ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision>"
    made = written(tmp_path, HUSKY.urdf.replace('<link name="laser">', f'<link name="laser">{ball}'))
    assert f"{HUSKY.mass:.1f} kg" in made.rover.summary


def test_wheels_may_be_named(tmp_path: Path) -> None:
    sides = {"left": ("rear_left_wheel_joint",), "right": ("rear_right_wheel_joint",)}
    assert written(tmp_path, HUSKY.urdf, **sides).rover.wheel_joints == (*sides["left"], *sides["right"])


ELSEWHERE = '<geometry><mesh filename="package://p/../../b.stl"/></geometry>'
MESH = '<geometry><mesh filename="package://p/{}"/></geometry>'
MISTAKES = {
    "not XML": ("<robot", "is not valid XML"),
    "not URDF": ("<sdf/>", "is not URDF: it holds <sdf>"),
    "empty": ("<robot/>", "holds no <link>"),
    "entities": ('<!DOCTYPE r [<!ENTITY a "b">]><robot/>', "declares entities"),
    "no wheels": (HUSKY.urdf.replace("continuous", "fixed"), "no wheels were found on both sides"),
    "zero mass": (
        HUSKY.urdf.replace('mass value="2.637"', 'mass value="0"'),
        "link 'front_left_wheel' has mass 0",
    ),
    "no inertia": (HUSKY.urdf.replace('ixx="', 'ixx="-', 1), "give numbers above 0"),
    "no number": (
        HUSKY.urdf.replace('mass value="2.637"', 'mass value="x"'),
        "a mass and an inertia in numbers",
    ),
    "damping": (
        HUSKY.urdf.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><dynamics damping="-5"/>', 1),
        "damping -5 of joint 'front_left_wheel_joint' is not valid; give 0 to",
    ),
    "a mass": (
        HUSKY.urdf.replace('mass value="2.637"', 'mass value="1e30"', 1),
        "mass 1e+30 kg of body 'front_left_wheel'",
    ),
    "endless": (HUSKY.urdf + " " * 20_000_000, "has more than 20 MB"),
    "no mesh": (
        HUSKY.urdf.replace(
            "<collision>", f"<collision>{MESH.format('a.stl')}</collision><collision>", 1
        ),
        "collision mesh package://p/a.stl is not there",
    ),
    "a mesh elsewhere": (
        HUSKY.urdf.replace("<collision>", f"<collision>{ELSEWHERE}</collision><collision>", 1),
        "is outside of the URDF's folder; name its folder by --resource-path",
    ),
    "DAE": (
        HUSKY.urdf.replace(
            "<collision>", f"<collision>{MESH.format('a.dae')}</collision><collision>", 1
        ),
        "is no .stl or .obj or .msh; convert it",
    ),
}


@pytest.mark.parametrize(("urdf", "told"), MISTAKES.values(), ids=MISTAKES)
def test_a_urdf_that_is_no_rover_is_reported_in_one_line(urdf: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "b.stl").touch()
    (folder := tmp_path / "p" / "q").mkdir(parents=True)
    (folder / "a.dae").touch()
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


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["../x", "--from", "robot.urdf"], "name '../x' is not valid"),
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
