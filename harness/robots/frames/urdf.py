"""A URDF of a rover: a link for each of its frames, with what the compiled model knows of it.

Masses and inertias, joints with their limits and friction, and what is to be seen. Of shapes URDF has
boxes, cylinders, spheres and meshes: a capsule is three of them, anything else the box around it.
"""

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from harness.base.sdf.poses import transform
from harness.robots.frames.rover_frames import SLIDE, Link, Matrix, RoverFrames
from harness.robots.model import SEEN_GROUP

BOX, CYLINDER, SPHERE, CAPSULE, MESH = (
    int(getattr(mujoco.mjtGeom, f"mjGEOM_{name}"))
    for name in ("BOX", "CYLINDER", "SPHERE", "CAPSULE", "MESH")
)
GIMBAL_LOCK = 1e-9

Shape = tuple[str, dict[str, str], Matrix]  # element, its attributes, shape_in_geom


def write_urdf(frames: RoverFrames) -> str:
    """Returns the URDF; metres, kilograms, radians."""
    model = frames.model
    robot = ET.Element("robot", name=frames.name)
    for index in range(model.nmat):
        add_material(robot, model.mat(index).name, model.mat_rgba[index])
    for link in frames.links:
        element = ET.SubElement(robot, "link", name=link.name)
        if link.carries:
            _add_inertial(element, link, frames)
            _add_visuals(element, link, frames)
    for link in frames.links[1:]:
        _add_joint(robot, link, frames)
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode") + "\n"


def add_material(above: ET.Element, name: str, rgba: Iterable[float]) -> None:
    """Adds a material of a colour to a visual or a robot."""
    material = ET.SubElement(above, "material", name=name)
    ET.SubElement(material, "color", rgba=" ".join(f"{part:.4g}" for part in rgba))


def add_origin(above: ET.Element, pose: Matrix) -> None:
    """Adds a pose, shape (4, 4) [m], to a joint, an inertial or a shape."""
    ET.SubElement(above, "origin", xyz=text_of_numbers(pose[:3, 3]), rpy=text_of_numbers(_angles(pose)))


def _add_inertial(element: ET.Element, link: Link, frames: RoverFrames) -> None:
    """Mass, centre, and the inertia about it in the link's axes."""
    model, data, body = frames.model, frames.data, link.body
    if not model.body_mass[body]:
        return
    in_link = np.linalg.inv(link.in_base) @ transform(data.xipos[body], data.ximat[body])
    turn, centre = in_link[:3, :3], np.eye(4)
    centre[:3, 3] = in_link[:3, 3]
    inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
    inertial = ET.SubElement(element, "inertial")
    add_origin(inertial, centre)
    ET.SubElement(inertial, "mass", value=text_of_numbers([model.body_mass[body]]))
    rows, columns = np.triu_indices(3)
    cells = zip(rows, columns, strict=True)
    named = {f"i{'xyz'[i]}{'xyz'[j]}": text_of_numbers([inertia[i, j]]) for i, j in cells}
    ET.SubElement(inertial, "inertia", named)


def _add_visuals(element: ET.Element, link: Link, frames: RoverFrames) -> None:
    """What is to be seen of the link's body."""
    model, data = frames.model, frames.data
    of_body = np.flatnonzero((model.geom_bodyid == link.body) & (model.geom_group == SEEN_GROUP))
    for geom in of_body.tolist():
        geom_in_base = transform(data.geom_xpos[geom], data.geom_xmat[geom])
        geom_in_link = np.linalg.inv(link.in_base) @ geom_in_base
        for shape, attributes, shape_in_geom in _shapes(model, geom):
            visual = ET.SubElement(element, "visual")
            add_origin(visual, geom_in_link @ shape_in_geom)
            ET.SubElement(ET.SubElement(visual, "geometry"), shape, attributes)
            if model.geom_matid[geom] >= 0:
                ET.SubElement(visual, "material", name=model.mat(model.geom_matid[geom]).name)
            else:
                add_material(visual, f"geom_{geom}", model.geom_rgba[geom])


def _shapes(model: mujoco.MjModel, geom: int) -> Iterator[Shape]:
    """What a geom looks like."""
    kind, (x, y, z) = int(model.geom_type[geom]), model.geom_size[geom].tolist()
    if kind == MESH and model.mesh_pathadr[model.geom_dataid[geom]] >= 0:
        yield _mesh(model, int(model.geom_dataid[geom]))
    elif kind == BOX:
        yield "box", {"size": text_of_numbers([2 * x, 2 * y, 2 * z])}, np.eye(4)
    elif kind == SPHERE:
        yield "sphere", {"radius": text_of_numbers([x])}, np.eye(4)
    elif kind in (CYLINDER, CAPSULE):
        yield "cylinder", {"radius": text_of_numbers([x]), "length": text_of_numbers([2 * y])}, np.eye(4)
        for end in (-y, y) if kind == CAPSULE else ():
            yield "sphere", {"radius": text_of_numbers([x])}, transform((0.0, 0.0, end), np.eye(3))
    else:
        centre, half_size = np.split(model.geom_aabb[geom], 2)
        yield "box", {"size": text_of_numbers(2 * half_size)}, transform(centre, np.eye(3))


def _mesh(model: mujoco.MjModel, mesh: int) -> Shape:
    """A mesh as in its file: MuJoCo moves its origin to its centre of mass and turns its axes."""
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.mesh_quat[mesh])
    path = Path(bytes(model.paths[model.mesh_pathadr[mesh] :]).split(b"\0")[0].decode())
    attributes = {"filename": path.resolve().as_uri(), "scale": text_of_numbers(model.mesh_scale[mesh])}
    mesh_in_file = transform(model.mesh_pos[mesh], rotation)
    return "mesh", attributes, np.asarray(np.linalg.inv(mesh_in_file))


def _add_joint(robot: ET.Element, link: Link, frames: RoverFrames) -> None:
    """What ties a link to its parent: fixed, or the model's joint with its name."""
    joint, model = link.joint, frames.model
    name = model.joint(joint).name if joint >= 0 else f"{link.name}_joint"
    element = ET.SubElement(robot, "joint", name=name, type=_joint_type(model, joint))
    ET.SubElement(element, "parent", link=link.parent)
    ET.SubElement(element, "child", link=link.name)
    add_origin(element, frames.in_parent(link))
    if joint < 0:
        return
    ET.SubElement(element, "axis", xyz=text_of_numbers(frames.axis(link)))
    dof = model.jnt_dofadr[joint]
    damping, friction = (
        text_of_numbers([model.dof_damping[dof]]),
        text_of_numbers([model.dof_frictionloss[dof]]),
    )
    ET.SubElement(element, "dynamics", damping=damping, friction=friction)
    ET.SubElement(element, "limit", _limits(model, joint))


def _joint_type(model: mujoco.MjModel, joint: int) -> str:
    if joint < 0:
        return "fixed"
    turning = "revolute" if model.jnt_limited[joint] else "continuous"
    return "prismatic" if model.jnt_type[joint] == SLIDE else turning


def _limits(model: mujoco.MjModel, joint: int) -> dict[str, str]:
    """Effort and speed of the motor, 0 where there is none; the range, if the joint has one."""
    motors = np.flatnonzero(model.actuator_trnid[:, 0] == joint).tolist()
    effort = model.actuator_forcerange[motors, 1].sum()
    velocity = model.actuator_ctrlrange[motors, 1].max(initial=0.0)
    limits = {"effort": text_of_numbers([effort]), "velocity": text_of_numbers([velocity])}
    if model.jnt_limited[joint]:
        lower, upper = model.jnt_range[joint]
        limits |= {"lower": text_of_numbers([lower]), "upper": text_of_numbers([upper])}
    return limits


def _angles(pose: Matrix) -> list[float]:
    """Roll, pitch and yaw about fixed axes; yaw is 0 where only its difference to roll counts."""
    level = math.hypot(pose[0, 0], pose[1, 0])
    pitch = math.atan2(-pose[2, 0], level)
    if level < GIMBAL_LOCK:
        return [math.atan2(-pose[1, 2], pose[1, 1]), pitch, 0.0]
    return [math.atan2(pose[2, 1], pose[2, 2]), pitch, math.atan2(pose[1, 0], pose[0, 0])]


def text_of_numbers(values: Iterable[float]) -> str:
    """Returns numbers to a picometre: what is left of roundings is 0."""
    return " ".join(f"{round(float(value), 12) + 0.0:.12g}" for value in values)
