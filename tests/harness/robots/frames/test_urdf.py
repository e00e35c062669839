"""The URDF, read back by MuJoCo and by yourdfpy, against the compiled model that it is of."""

import math
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.robots.frames.rover_frames import rover_frames
from harness.robots.frames.urdf import write_urdf
from harness.robots.model import read_model
from tests.harness.robots.frames.made_rover import made_rover
from tests.support.rovers import LEO, ROVER_ZERO4WD

EXACT = 1e-6


def read_back(urdf: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The model that MuJoCo makes of it, every link a body."""
    spec = mujoco.MjSpec.from_string(urdf)
    spec.compiler.fusestatic = False
    model = spec.compile()
    return model, mujoco.MjData(model)


def posed(rover: RoverSpec, seed: int) -> tuple[mujoco.MjModel, mujoco.MjData, dict[str, float]]:
    """The rover's model at the origin, its joints at random."""
    model = read_model(rover).compile()
    data = mujoco.MjData(model)
    rng = np.random.default_rng(seed)
    angles = {name: float(rng.uniform(-0.2, 0.2)) for name in rover.joints}
    data.qpos[:7] = (0, 0, 0, 1, 0, 0, 0)
    for name, angle in angles.items():
        data.joint(name).qpos[0] = angle
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    return model, data, angles


def parse(urdf: str, folder: Path) -> Any:  # noqa: ANN401 - it has no types
    """What yourdfpy reads."""
    yourdfpy = pytest.importorskip("yourdfpy", reason="needs the extra [dev]: make setup")
    file = folder / "rover.urdf"
    file.write_text(urdf)
    return yourdfpy.URDF.load(str(file), build_scene_graph=True, load_meshes=False)


both = pytest.mark.parametrize("rover", [LEO, ROVER_ZERO4WD], ids=lambda rover: rover.name)


@both
def test_mujoco_reads_back_masses_joints_and_how_the_rover_moves(rover: RoverSpec) -> None:
    """Mass, centre and joint-space inertia of the moving parts hold all of masses, axes and inertias."""
    model, data, angles = posed(rover, seed=1)
    back, back_data = read_back(write_urdf(rover_frames(rover)))
    assert back.body_mass.sum() == pytest.approx(model.body_mass.sum(), abs=EXACT)
    assert {back.joint(index).name for index in range(back.njnt)} == set(rover.joints)
    for name, angle in angles.items():
        back_data.joint(name).qpos[0] = angle
    for m, d in ((model, data), (back, back_data)):
        m.dof_armature[:] = 0.0  # a rotor's, which URDF does not know
        mujoco.mj_fwdPosition(m, d)
    for name in rover.joints:
        ours, theirs = data.joint(name), back_data.joint(name)
        assert theirs.xaxis == pytest.approx(ours.xaxis, abs=EXACT)
        along = np.cross(theirs.xanchor - ours.xanchor, ours.xaxis)
        assert along == pytest.approx(np.zeros(3), abs=EXACT), "the same line"
        made, read = model.joint(name), back.joint(name)
        assert read.damping == pytest.approx(made.damping, abs=EXACT)
        assert read.frictionloss == pytest.approx(made.frictionloss, abs=EXACT)
        assert read.limited == made.limited
        assert not made.limited or read.range == pytest.approx(made.range, abs=EXACT)
    dofs, back_dofs = ([int(m.joint(name).dofadr[0]) for name in rover.joints] for m in (model, back))
    assert whole(back, back_data)[np.ix_(back_dofs, back_dofs)] == pytest.approx(
        whole(model, data)[np.ix_(dofs, dofs)], abs=EXACT
    )
    assert back_data.subtree_com[0] == pytest.approx(data.subtree_com[0], abs=EXACT)
    assert spin(back, back_data) == pytest.approx(spin(model, data), abs=EXACT)


def whole(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    """The joint-space inertia."""
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    return inertia


def spin(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    """The inertia of all bodies about the world's origin, shape (3, 3)."""
    total = np.zeros((3, 3))
    for body in range(1, model.nbody):
        turn, centre = data.ximat[body].reshape(3, 3), data.xipos[body]
        total += turn @ np.diag(model.body_inertia[body]) @ turn.T
        total += model.body_mass[body] * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return total


@both
def test_yourdfpy_finds_links_where_mujoco_has_them(rover: RoverSpec, tmp_path: Path) -> None:
    _, data, angles = posed(rover, seed=2)
    frames = rover_frames(rover)
    urdf = parse(write_urdf(frames), tmp_path)
    assert urdf.validate()
    assert urdf.base_link == rover.odometry_child_frame
    urdf.update_cfg(angles)
    for link in frames.links:
        now, at_rest = np.eye(4), np.eye(4)  # the frame moves with its body as it lies in it at rest
        for pose, state in ((now, data), (at_rest, frames.data)):
            pose[:3, 3], pose[:3, :3] = state.xpos[link.body], state.xmat[link.body].reshape(3, 3)
        expected = now @ np.linalg.inv(at_rest) @ link.in_base
        assert urdf.get_transform(link.name, urdf.base_link) == pytest.approx(expected, abs=EXACT)


def test_shapes_colours_meshes_and_a_slide(tmp_path: Path) -> None:
    """A mesh lies where its file says, although MuJoCo moves and turns it."""
    import trimesh  # noqa: PLC0415 - comes with yourdfpy

    half, roll = math.sqrt(0.5), math.radians(10.0)  # a pitch of 90 degrees: roll and yaw are one
    w, x = half * math.cos(roll), half * math.sin(roll)
    (tmp_path / "meshes").mkdir()
    block = trimesh.creation.box((0.1, 0.2, 0.3)).apply_translation((1.0, 2.0, 3.0))
    block.export(tmp_path / "meshes" / "block.stl")
    seen = 'contype="0" conaffinity="0" mass="0"'
    body = (
        f'<geom type="mesh" mesh="block" pos="0.5 0 0" {seen} material="red"/>'
        f'<geom type="ellipsoid" size="0.1 0.2 0.3" pos="0 0 9" {seen}/>'
        f'<geom type="sphere" size="0.4" {seen} rgba="0 0.5 1 1"/><geom type="box" size="1 1 1"/>'
        f'<geom type="capsule" size="0.1 0.5" pos="0 0 5" euler="0 90 0" {seen}/>'
        '<body name="lift" pos="0.1 0 0.2"><joint name="lift" type="slide" axis="0 0 1" range="0 0.5" '
        f'limited="true"/><geom type="box" size="0.1 0.2 0.3" quat="{w} {x} {w} {-x}" group="2"/></body>'
    )
    assets = '<mesh name="block" file="block.stl" scale="1 2 1"/><material name="red" rgba="1 0 0 1"/>'
    frames = rover_frames(made_rover(tmp_path, body, assets))
    told = parse(write_urdf(frames), tmp_path)
    mesh, ellipsoid, sphere, *capsule = told.link_map["base_footprint"].visuals
    assert mesh.geometry.mesh.filename == (tmp_path / "meshes" / "block.stl").as_uri()
    assert ellipsoid.geometry.box.size == pytest.approx((0.2, 0.4, 0.6))
    assert sphere.geometry.sphere.radius == pytest.approx(0.4)
    shaft, *ends = (visual.geometry for visual in capsule)
    assert (shaft.cylinder.radius, shaft.cylinder.length) == pytest.approx((0.1, 1.0))
    assert [end.sphere.radius for end in ends] == pytest.approx([0.1, 0.1])
    places = np.array([visual.origin[:3, 3] for visual in capsule])
    assert places == pytest.approx(np.array([(0, 0, 5), (-0.5, 0, 5), (0.5, 0, 5)]), abs=EXACT)
    assert told.robot.materials[0].color.rgba == pytest.approx((1, 0, 0, 1))
    assert mesh.material.name == told.robot.materials[0].name == "red"
    assert sphere.material.color.rgba == pytest.approx((0, 0.5, 1, 1))
    corners = block.vertices * mesh.geometry.mesh.scale @ mesh.origin[:3, :3].T + mesh.origin[:3, 3]
    assert corners.min(axis=0) == pytest.approx((1.45, 3.8, 2.85), abs=EXACT)
    assert corners.max(axis=0) == pytest.approx((1.55, 4.2, 3.15), abs=EXACT)
    joint = told.joint_map["lift"]
    assert (joint.type, joint.limit.lower, joint.limit.upper) == ("prismatic", 0.0, 0.5)
    told.update_cfg({"lift": 0.3})
    assert told.get_transform("lift_link", told.base_link)[:3, 3] == pytest.approx((0.1, 0.0, 0.5))
    (visual,) = told.link_map["lift_link"].visuals
    expected = frames.data.geom_xmat[-1].reshape(3, 3)
    assert visual.origin[:3, :3] == pytest.approx(expected, abs=EXACT)
