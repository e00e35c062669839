"""The frames of a rover: from the bodies, joints and sites of its compiled model, and rover.yaml.

The model alone is compiled, at the origin and with all joints at 0: there the pose of each frame is
asked of MuJoCo. Poses are homogeneous matrices, shape (4, 4).
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError, find_named
from harness.base.sdf.poses import transform
from harness.robots import RoverSpec
from harness.robots.frames.tree import Edge, check_tree
from harness.robots.measures import frame_name
from harness.robots.model import ROOT_ID, compiled_alone
from harness.robots.sections import FrameRow
from harness.samples import Quaternion, Vector3

Matrix = NDArray[np.float64]

ROUNDING = 1e-12
ON_AXIS = 1e-9  # [m]: a link's origin lies on its joint's axis
HINGE, SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)


@dataclass(frozen=True, eq=False)
class BodyFrame:
    """A frame that is fixed to a body of the scene: origin [m] and R_body_sensor, shape (3, 3)."""

    body: int
    xyz: NDArray[np.float64]
    axes: NDArray[np.float64]

    def pose(self, data: mujoco.MjData) -> NDArray[np.float64]:
        """Returns origin in the world [m] and below it the rotation R_world_sensor, shape (4, 3).

        The poses in `data` must be those of its qpos: after mj_step, call mj_kinematics first.
        """
        turn = data.xmat[self.body].reshape(3, 3)
        return np.vstack([data.xpos[self.body] + turn @ self.xyz, turn @ self.axes])


@dataclass(frozen=True, eq=False)
class Link:
    """One frame of a rover."""

    name: str
    parent: str  # its parent's name; empty for the base
    body: int  # the body of the model to which it is fixed
    carries: bool  # whether its link has the body's mass and shapes
    in_base: Matrix  # where it is while all joints are at 0
    joint: int  # the model's joint by which it moves in its parent; -1 if it is fixed there


@dataclass(frozen=True, eq=False)
class RoverFrames:
    """All frames of a rover, the base first, every parent before its children."""

    name: str  # name of the rover
    model: mujoco.MjModel  # the rover alone, with what is only to be seen
    data: mujoco.MjData  # its state at the origin, all joints at 0
    links: tuple[Link, ...]

    @property
    def base(self) -> str:
        """The frame whose pose in odom is published."""
        return self.links[0].name

    @property
    def moving(self) -> tuple[Link, ...]:
        """The frames that a joint moves."""
        return tuple(link for link in self.links if link.joint >= 0)

    def edge(self, link: Link) -> Edge:
        """Returns a frame in its parent while the joint between them is at 0."""
        translation, rotation = pose_of(self.in_parent(link))
        return Edge(link.parent, link.name, translation, rotation)

    def in_parent(self, link: Link) -> Matrix:
        """Returns the pose of a frame in its parent while the joint between them is at 0."""
        return np.linalg.inv(self._link(link.parent).in_base) @ link.in_base

    def _link(self, name: str) -> Link:
        return next(link for link in self.links if link.name == name)

    def mount(self, frame: str, scene: mujoco.MjModel, prefix: str = "") -> BodyFrame:
        """Returns where one of the frames is in a scene that the rover has been put into.

        Args:
            frame: The frame's name.
            scene: The model of the scene.
            prefix: What the rover's names begin with there.
        """
        link, data = self._link(frame), self.data
        body = link.body
        in_body = np.linalg.inv(transform(data.xpos[body], data.xmat[body])) @ link.in_base
        carrier = scene.body(prefix + self.model.body(body).name).id
        return BodyFrame(carrier, in_body[:3, 3], in_body[:3, :3])

    def axis(self, link: Link) -> Matrix:
        """Returns the axis of a frame's joint in its own axes, shape (3,)."""
        turned: Matrix = self.data.xaxis[link.joint] @ link.in_base[:3, :3]
        return turned


def rover_frames(rover: RoverSpec, mounts: Iterable[FrameRow] = ()) -> RoverFrames:
    """Returns the frames of a rover, with those of the optional sensors that it carries.

    UsageError if the frames of rover.yaml are no tree, or do not fit the model.
    """
    model, data = compiled_alone(rover)
    where = rover.folder / "rover.yaml"
    rows = (*rover.frames, *_of_the_model(rover, model), *mounts)
    base = rover.odometry_child_frame
    check_tree(base, [(row.parent, row.child) for row in rows], where)
    carried = {row.body for row in rows if row.body}
    links = {base: Link(base, "", ROOT_ID, model.body(ROOT_ID).name not in carried, np.eye(4), -1)}
    waiting = list(rows)
    while waiting:  # a parent may stand below its child in the file
        row = next(row for row in waiting if row.parent in links)
        waiting.remove(row)
        links[row.child] = _link(row, links[row.parent], model, data, where)
    return RoverFrames(rover.name, model, data, tuple(links.values()))


def _of_the_model(rover: RoverSpec, model: mujoco.MjModel) -> Iterator[FrameRow]:
    """A frame for each body, the lidar and the IMU, where rover.yaml has none."""
    named = {row.child for row in rover.frames}
    frame_of = {row.body: row.child for row in rover.frames if row.body}
    frame_of.setdefault(model.body(ROOT_ID).name, rover.odometry_child_frame)
    for body in range(1, model.nbody):  # a parent stands before its children
        name = model.body(body).name
        if name not in frame_of:
            above = model.body(model.body_parentid[body]).name
            frame_of[name] = frame_name(name)
            anchor = model.jnt_pos[model.body_jntadr[body]] if model.body_jntnum[body] else np.zeros(3)
            xyz = tuple(anchor.tolist())
            yield FrameRow(parent=frame_of[above], child=frame_of[name], body=name, xyz=xyz)
    for site, frame in (("lidar", rover.lidar_frame), ("imu", rover.imu_frame)):
        if frame not in named and frame not in frame_of.values():
            on = model.body(model.site(site).bodyid[0]).name
            yield FrameRow(parent=frame_of[on], child=frame, site=site)


def _link(
    row: FrameRow, parent: Link, model: mujoco.MjModel, data: mujoco.MjData, where: object
) -> Link:
    """The link of a row whose parent's is known."""
    offset = transform(row.xyz, _of_angles(row.rpy))
    if row.body:
        bodies = {model.body(index).name: index for index in range(1, model.nbody)}
        body = find_named(f"{where}: body", row.body, bodies)
        pose = transform(data.xpos[body], data.xmat[body]) @ offset
    elif row.site:
        sites = {model.site(index).name: index for index in range(model.nsite)}
        site = find_named(f"{where}: site", row.site, sites)
        body = int(model.site_bodyid[site])
        pose = transform(data.site_xpos[site], data.site_xmat[site]) @ offset
    else:
        body, pose = parent.body, parent.in_base @ offset
    joint = _joint_between(row, parent.body, body, model, where)
    if joint >= 0 and model.jnt_type[joint] == HINGE:
        aside = np.cross(pose[:3, 3] - data.xanchor[joint], data.xaxis[joint])
        if np.linalg.norm(aside) > ON_AXIS:
            raise UsageError(
                f"{where}: frame '{row.child}' is {np.linalg.norm(aside):.3g} m off the axis of its "
                f"joint '{model.joint(joint).name}'; give an xyz on it, in the body '{row.body}'"
            )
    return Link(row.child, row.parent, body, bool(row.body), pose, joint)


def _joint_between(row: FrameRow, above: int, body: int, model: mujoco.MjModel, where: object) -> int:
    """The joint that moves a body's frame in that of another body; -1 if nothing moves between them."""
    weld = model.body_weldid
    if weld[above] == weld[body]:
        return -1
    name, carrier = model.body(body).name, model.body(model.body_parentid[weld[body]]).name
    if weld[body] != body or weld[model.body_parentid[body]] != weld[above]:
        raise UsageError(
            f"{where}: frame '{row.child}' moves with the body '{name}', which hangs on '{carrier}': "
            f"'{row.parent}' does not; give a parent that is fixed to '{carrier}'"
        )
    joint = int(model.body_jntadr[body])
    if model.body_jntnum[body] != 1 or model.jnt_type[joint] not in (HINGE, SLIDE):
        raise UsageError(
            f"{where}: the body '{name}' must hang on one hinge or slide for frame '{row.child}' to "
            "move with it; give each joint a body of its own"
        )
    return joint


def pose_of(matrix: Matrix) -> tuple[Vector3, Quaternion]:
    """Returns translation and quaternion (x, y, z, w) of a homogeneous matrix; no roundings are left."""
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, matrix[:3, :3].ravel())
    w, qx, qy, qz = cleared(quaternion)
    x, y, z = cleared(matrix[:3, 3])
    return (x, y, z), (qx, qy, qz, w)


def cleared(values: Matrix) -> list[float]:
    """Returns values, 0 in the place of what is left of roundings [m, or of a unit vector]."""
    return [0.0 if abs(value) < ROUNDING else value for value in values.tolist()]


def _of_angles(rpy: Vector3) -> Matrix:
    """The rotation of roll, pitch and yaw about fixed axes, as URDF has them."""
    quaternion, matrix = np.empty(4), np.empty(9)
    mujoco.mju_euler2Quat(quaternion, np.array(rpy), "XYZ")
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix
