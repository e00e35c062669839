"""The frames of both rovers are the real ones'; what does not fit a model is told in one line."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.robots import RoverSpec
from harness.robots.content import MODELS_DIR
from harness.robots.frames.rover_frames import rover_frames
from harness.robots.frames.tree import check_tree
from harness.robots.sections import FrameRow
from tests.harness.robots.frames.made_rover import made_rover
from tests.support.rovers import LEO, ROVER_ZERO4WD

PI = math.pi
# Parent and child, x y z [m] and roll pitch yaw [rad] of the child in it, at rest. Leo: macros.xacro
# 1.2.1 and RoboTerrain's lidar; rover_zero4wd: rover_4wd.urdf, its accessories and RoboTerrain's SDF.
# In the order of the models, in which they are told.
REAL: dict[str, dict[tuple[str, str], tuple[float, ...]]] = {
    "leo": {
        ("base_footprint", "base_link"): (0, 0, 0.19783, 0, 0, 0),
        ("base_link", "rocker_L_link"): (0.00263, 0.14167, -0.04731, 0, 0, PI),
        ("base_link", "rocker_R_link"): (0.00263, -0.14167, -0.04731, 0, 0, 0),
        ("rocker_L_link", "wheel_FL_link"): (-0.15256, -0.08214, -0.08802, 0, 0, 0),
        ("rocker_L_link", "wheel_RL_link"): (0.15256, -0.08214, -0.08802, 0, 0, 0),
        ("rocker_R_link", "wheel_FR_link"): (0.15256, -0.08214, -0.08802, 0, 0, 0),
        ("rocker_R_link", "wheel_RR_link"): (-0.15256, -0.08214, -0.08802, 0, 0, 0),
        ("base_link", "lidar_link"): (0.174, 0, 0.6, 0, 0, PI),
        ("base_link", "imu_frame"): (0.0628, -0.0314, -0.0393, 0, 0, 0),
        ("base_link", "antenna_link"): (-0.0052, 0.056, -0.0065, 0, 0, 0),
        ("base_link", "camera_frame"): (0.0971, 0, -0.0427, 0, 0.2094, 0),
        ("camera_frame", "camera_optical_frame"): (0, 0, 0, -PI / 2, 0, -PI / 2),
    },
    "rover_zero4wd": {
        ("base_link", "chassis_link"): (0, 0, 0.125, 0, 0, 0),
        ("chassis_link", "fl_wheel_link"): (0.1415, 0.18, 0, 0, 0, 0),
        ("chassis_link", "rl_wheel_link"): (-0.145, 0.18, 0, 0, 0, 0),
        ("chassis_link", "fr_wheel_link"): (0.1415, -0.18, 0, 0, 0, 0),
        ("chassis_link", "rr_wheel_link"): (-0.145, -0.18, 0, 0, 0, 0),
        ("chassis_link", "payload_link"): (0, 0, 0.096, 0, 0, 0),
        ("payload_link", "imu_link"): (0, 0, 0, 0, 0, 0),
        ("payload_link", "lidar_link"): (0.174, 0, 0.1, 0, 0, PI),
        ("base_link", "camera_link"): (0.2, 0, 0.3, 0, 0, 0),
    },
}


@pytest.mark.parametrize("rover", [LEO, ROVER_ZERO4WD], ids=lambda rover: rover.name)
def test_frames_are_those_of_the_real_rover(rover: RoverSpec) -> None:
    frames = rover_frames(rover)
    page = (MODELS_DIR.parent / "docs" / "frames.md").read_text()
    assert all(link.name in page for link in frames.links)
    assert frames.base == rover.odometry_child_frame
    assert {frames.model.joint(link.joint).name for link in frames.moving} == set(rover.joints)
    edges = {(link.parent, link.name): frames.edge(link) for link in frames.links[1:]}
    assert edges.keys() == REAL[rover.name].keys()
    for names, (x, y, z, *rpy) in REAL[rover.name].items():
        assert edges[names].translation == pytest.approx((x, y, z), abs=1e-9)
        numbers = np.array([*edges[names].translation, *edges[names].rotation])
        assert (numbers[np.abs(numbers) < 1e-9] == 0.0).all(), "no roundings are left"
        turn = Rotation.from_quat(edges[names].rotation) * Rotation.from_euler("xyz", rpy).inv()
        assert turn.magnitude() == pytest.approx(0.0, abs=1e-6)


def test_a_rover_yaml_without_frames_has_those_of_its_model() -> None:
    frames = rover_frames(LEO.but(frames=()))
    links = {link.name: link.parent for link in frames.links}
    rockers = {f"rocker_{side}_link": "base_footprint" for side in "LR"}
    wheels = {f"wheel_{end}{side}_link": f"rocker_{side}_link" for side in "LR" for end in "FR"}
    sensors = {"lidar_link": "base_footprint", "imu_frame": "base_footprint"}
    assert links == {"base_footprint": "", **rockers, **wheels, **sensors}
    assert frames.edge(frames.links[-2]).translation == pytest.approx((0.174, 0.0, 0.79783))


def row(parent: str, child: str, **where: object) -> FrameRow:
    return FrameRow(parent=parent, child=child, **where)  # type: ignore[arg-type]  # a table of keywords


@pytest.mark.parametrize(
    ("added", "message"),
    [
        (row("base_link", "nose", body="nozzle"), "body 'nozzle' does not exist; available: rover"),
        (row("base_link", "nose", site="nozzle"), "site 'nozzle' does not exist; available: imu, lidar"),
        (
            row("base_link", "hub", body="wheel_FL"),
            "'base_link' does not; give a parent that is fixed to 'rocker_L'",
        ),
        (
            row("base_link", "elbow", body="rocker_L", xyz=(0.03, 0.2, 0.04)),
            "frame 'elbow' is 0.05 m off the axis of its joint 'rocker_L_joint'; give an xyz on it",
        ),
    ],
)
def test_a_frame_that_does_not_fit_is_told_in_one_line(added: FrameRow, message: str) -> None:
    with pytest.raises(UsageError) as told:
        rover_frames(LEO.but(frames=(*LEO.frames, added)))
    assert message in str(told.value)
    assert "\n" not in str(told.value)


def test_a_body_that_hangs_on_two_joints_is_refused(tmp_path: Path) -> None:
    head = (
        '<body name="head"><joint name="pan"/><joint name="tilt" axis="0 1 0"/><geom size="0.1"/></body>'
    )
    with pytest.raises(UsageError, match=r"'head' must hang on one hinge or slide .* of its own$"):
        rover_frames(made_rover(tmp_path, head))


@pytest.mark.parametrize(
    ("edges", "message"),
    [
        ("base-mast base-lidar mast-lidar", "'lidar' has two parents, base and mast; leave one out"),
        ("base-mast head-neck neck-head", "in a loop, neck -> head -> neck; let one hang on 'base'"),
        ("base-mast mast-base", "is the base and has no parent; leave out mast"),
        ("base-mast pole-lidar", "which does not exist; available: base, mast, lidar"),
    ],
)
def test_what_is_no_tree_is_told_and_a_parent_may_stand_below_its_child(
    edges: str, message: str
) -> None:
    check_tree("base", [("mast", "lidar"), ("base", "mast")], "rover.yaml")
    pairs = [(parent, child) for parent, _, child in (edge.partition("-") for edge in edges.split())]
    with pytest.raises(UsageError, match=f"^rover.yaml: frame.*{re.escape(message)}$"):
        check_tree("base", pairs, "rover.yaml")
