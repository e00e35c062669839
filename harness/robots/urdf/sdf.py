"""A model in SDF as the URDF that says the same, of which a rover is made.

SDF has a pose for each link and one for each joint; in URDF a link's frame is at the joint that carries
it. So what hangs on a joint that moves gets its frame there, turned as it was.
"""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from harness.base.errors import UsageError
from harness.base.sdf.poses import IDENTITY, Transform, inverse, transform
from harness.base.sdf.reader import color_of, is_true, numbers, text_of
from harness.robots.frames.urdf import add_material, add_origin, text_of_numbers
from harness.robots.urdf.equipment import IMU, LIDAR
from harness.robots.urdf.sdf_elements import (
    WATER,
    angle_seen,
    dynamics_of,
    frame_of,
    limit_of,
    lump_of,
    mimic_of,
    shape_of,
)
from harness.robots.urdf.sdf_model import TWO_AXES, Joint, Model, read_model

SENSORS = {  # how their links are called, and the types that they have
    "lidar": (LIDAR, ("gpu_lidar", "gpu_ray", "lidar", "ray")),
    "imu": (IMU, ("imu",)),
}
AXES = ("xx", "yy", "zz", "xy", "xz", "yz")
LIMITLESS = 1e15  # [rad]: limits beyond it, as SDF's usual 1e16, are none
ENDLESS = "continuous"  # whatever limits it states
TURNING, SLIDING, HELD = ("revolute", ENDLESS), ("prismatic",), ("fixed", "ball")
KINDS = (*TURNING, *SLIDING, *HELD)
NO_JOINT = ("gearbox",)  # between links that have joints of their own


def urdf_of_sdf(
    root: Element, path: Path, folders: Sequence[Path], name: str
) -> tuple[Element, list[str]]:
    """Returns the <robot> that a model in SDF is, and what was left out or changed, a line each.

    Args:
        root: The <sdf>.
        path: Its file.
        folders: With what it includes, beside its own folder and those above.
        name: Of the model, where it holds several.

    Raises:
        UsageError: It holds no rover or several, or something in it is not valid.
    """
    try:
        model = read_model(root, path, folders, name)
        return _Writing(model).robot(), model.notes
    except UsageError as error:
        text = str(error)
        raise UsageError(text if text.startswith(f"{path}") else f"{path}: {text}") from error


class _Writing:
    def __init__(self, model: Model) -> None:
        self._model, self._notes = model, model.notes
        self._joints = {name: one for name, one in model.joints.items() if one.kind not in NO_JOINT}
        carried: dict[str, str] = {}
        children = {joint.child for joint in self._joints.values()}
        for name, stated in self._joints.items():
            self._check(name, stated)
            joint = stated
            if joint.child in carried and _kind(joint) == "fixed" and joint.parent not in children:
                joint = replace(joint, parent=joint.child, child=joint.parent)  # it hangs on the other
            if joint.child in carried:
                both = f"joints '{carried[joint.child]}' and '{name}'"
                raise UsageError(f"link '{joint.child}' hangs on {both}; take the loop apart")
            self._joints[name] = joint
            carried[joint.child] = name
        self._frames = {name: self._frame(name, carried.get(name, "")) for name in model.links}

    def _check(self, name: str, joint: Joint) -> None:
        if joint.kind not in KINDS:
            raise UsageError(f"joint '{name}' is '{joint.kind}'; valid: {', '.join(KINDS + TWO_AXES)}")
        for link in (joint.parent, joint.child):
            if link not in self._model.links:
                links = ", ".join(self._model.links)
                raise UsageError(f"joint '{name}' ties '{link}', which is no link; available: {links}")

    def _frame(self, name: str, carrier: str) -> Transform:
        """The frame in which URDF says what is in a link: a root's is turned as the model, x ahead."""
        pose = self._model.links[name].pose
        if not carrier:
            return transform(tuple(pose[:3, 3]), IDENTITY[:3, :3])
        joint = self._joints[carrier]
        return pose if _kind(joint) in HELD else transform(tuple(joint.pose[:3, 3]), pose[:3, :3])

    def robot(self) -> Element:
        """Returns the whole."""
        robot = Element("robot", name=self._model.name)
        held = {joint.child for joint in self._joints.values() if _kind(joint) in HELD}
        for name in self._model.links:
            self._link(robot, SubElement(robot, "link", name=name), name, moves=name not in held)
        for name, joint in self._joints.items():
            self._joint(robot, name, joint)
        for sensor in SENSORS:
            self._sensor(robot, sensor)
        SubElement(robot, "gazebo").extend(self._model.plugins)
        light = [link.get("name", "") for link in robot.iter("link") if link.find("inertial") is None]
        if light := [name for name in light if name in self._model.links]:
            names = ", ".join(light)
            self._notes.append(f"without <inertial>, so no mass, where Gazebo takes 1 kg each: {names}")
        return robot

    def _at(self, link: str, element: Element | None, owner: str) -> Transform:
        """The pose of what is in a link, in the frame of URDF's."""
        return inverse(self._frames[link]) @ self._model.links[link].at(element, owner)

    def _link(self, robot: Element, written: Element, name: str, *, moves: bool) -> None:
        link = self._model.links[name].element
        inertial = link.find("inertial")
        is_root = all(joint.child != name for joint in self._joints.values())
        shapes = link.findall("collision")
        if inertial is None and moves and (shapes or not is_root):
            inertial = Element("inertial")
        if inertial is not None:
            self._inertial(SubElement(written, "inertial"), inertial, name)
        for kind in ("visual", "collision"):
            for part in link.findall(kind):
                owner = f"{kind} '{part.get('name')}' of link '{name}'"
                shape = shape_of(part, owner)
                if isinstance(shape, str):
                    self._notes.append(f"{owner}: {shape}; dropped")
                    continue
                holder, is_ball = written, kind == "collision" and shape.tag == "sphere"
                if is_ball and shapes[1:] and (is_root or not moves):  # a caster, as part of a hull
                    holder = self._hung(robot, f"{name}_{part.get('name')}", name, IDENTITY)
                element = SubElement(holder, kind)
                add_origin(element, self._at(name, part, owner))
                SubElement(element, "geometry").append(shape)
                if (color := color_of(part)) is not None:
                    add_material(element, f"{name}_{part.get('name')}", color)

    def _inertial(self, written: Element, inertial: Element, name: str) -> None:
        moments = inertial.find("inertia")
        if is_true(inertial.get("auto", "")):
            self._lumped(written, inertial, name)
            return
        if moments is None:
            missing = "<inertia>, so" if len(inertial) else "<inertial>, so 1 kg and"
            self._notes.append(f"link '{name}' has no {missing} 1 kg m^2, as in Gazebo")
        values = {
            f"i{axes}": text_of(moments, f"i{axes}", "1" if axes in AXES[:3] else "0") for axes in AXES
        }
        add_origin(written, self._at(name, inertial, f"inertial of link '{name}'"))
        SubElement(written, "mass", value=text_of(inertial, "mass", "1"))
        SubElement(written, "inertia", values)

    def _lumped(self, written: Element, inertial: Element, name: str) -> None:
        """Says what the shapes that collide weigh, of which a stated mass is the whole."""
        usual = text_of(inertial, "density", WATER)
        shapes: list[tuple[Element, Transform, float]] = []
        for part in self._model.links[name].element.findall("collision"):
            owner = f"collision '{part.get('name')}' of link '{name}'"
            (density,) = numbers(text_of(part, "density", usual), 1, f"<density> of {owner}")
            if isinstance(shape := shape_of(part, owner), Element):
                shapes.append((shape, self._at(name, part, owner), density))
        own, middle, matrix = lump_of(shapes, name)
        (mass,) = numbers(text_of(inertial, "mass", f"{own}"), 1, f"<mass> of link '{name}'")
        matrix = matrix * (mass / own)
        add_origin(written, transform(tuple(middle), IDENTITY[:3, :3]))
        SubElement(written, "mass", value=f"{mass:.9g}")
        places = {f"i{axes}": tuple("xyz".index(axis) for axis in axes) for axes in AXES}
        SubElement(written, "inertia", {of: f"{matrix[place]:.9g}" for of, place in places.items()})

    def _joint(self, robot: Element, name: str, joint: Joint) -> None:
        axis = joint.element.find("axis")
        limit = None if axis is None else axis.find("limit")
        lower, upper = (limit_of(limit, tag) for tag in ("lower", "upper"))
        is_endless = joint.kind == ENDLESS or not (-LIMITLESS < lower <= upper < LIMITLESS)
        kind = (ENDLESS if is_endless else "revolute") if _kind(joint) in TURNING else _kind(joint)
        if joint.kind == "ball":
            kind = "fixed"
            self._notes.append(f"joint '{name}' is a ball's; held, so that what it carries slides")
        written = SubElement(robot, "joint", name=name, type=kind)
        SubElement(written, "parent", link=joint.parent)
        SubElement(written, "child", link=joint.child)
        frame = self._frames[joint.child]
        add_origin(written, inverse(self._frames[joint.parent]) @ frame)
        if kind == "fixed":
            return
        SubElement(written, "axis", xyz=text_of_numbers(frame[:3, :3].T @ joint.axis))
        stated = {tag: max(limit_of(limit, tag), 0.0) for tag in ("effort", "velocity")}
        limits = {tag: f"{value if value < LIMITLESS else 0.0:g}" for tag, value in stated.items()}
        ends = {} if is_endless else {"lower": f"{lower:.9g}", "upper": f"{upper:.9g}"}
        SubElement(written, "limit", limits | ends)
        dynamics = None if axis is None else axis.find("dynamics")
        SubElement(written, "dynamics", dict(dynamics_of(dynamics)))
        if axis is not None and (mimic := axis.find("mimic")) is not None:
            SubElement(written, "mimic", mimic_of(mimic, name))

    def _sensor(self, robot: Element, kind: str) -> None:
        """Adds the link of the lidar that sees most or the first IMU, unless it is at one called so."""
        pattern, types = SENSORS[kind]
        sensors = [
            (sensor, link)
            for link, one in self._model.links.items()
            for sensor in one.element.findall("sensor")
            if sensor.get("type") in types
        ]
        sensor, link = max(sensors, key=lambda of: angle_seen(of[0]), default=(None, ""))
        if sensor is None:
            return
        if len(sensors) > 1:
            names = ", ".join(of.get("name", kind) for of, _ in sensors)
            taken = sensor.get("name") if angle_seen(sensor) else "none, as they are single rays"
            self._notes.append(f"of several sensors for the {kind} ({names}) it has {taken}")
        if not angle_seen(sensor):
            return
        robot.set(kind, self._seat(robot, sensor, link, pattern, kind))

    def _seat(
        self, robot: Element, sensor: Element, link: str, pattern: re.Pattern[str], kind: str
    ) -> str:
        """The link in whose frame a sensor of another one is, which may have to be hung there."""
        at, called = self._at(link, sensor, f"sensor '{sensor.get('name')}'"), frame_of(sensor)
        if called in self._frames:
            if np.allclose(self._frames[called], self._frames[link] @ at):
                return called
            called = ""  # a frame from which what is seen is seen elsewhere
        if not called and pattern.search(link) and np.allclose(at, IDENTITY):
            return link
        name = called or sensor.get("name", kind)
        name = name if called or pattern.search(name) else f"{name}_{kind}"
        name = f"{link}_{name}" if name in self._model.links else name
        return self._hung(robot, name, link, at).get("name", "")

    def _hung(self, robot: Element, name: str, parent: str, at: Transform) -> Element:
        """A new link, held by another one; its name ends in _ where that one is taken."""
        taken = {*self._model.links, *(link.get("name") for link in robot.iter("link"))}
        while name in taken or f"{name}_joint" in self._joints:
            name += "_"
        joint = SubElement(robot, "joint", name=f"{name}_joint", type="fixed")
        SubElement(joint, "parent", link=parent)
        SubElement(joint, "child", link=name)
        add_origin(joint, at)
        return SubElement(robot, "link", name=name)


def _kind(joint: Joint) -> str:
    """A joint's type; one whose limits are both 0, as is usual where nothing shall turn, is `fixed`."""
    if joint.kind == ENDLESS:
        return joint.kind
    limit = joint.element.find("axis/limit")
    return joint.kind if any(limit_of(limit, tag) for tag in ("lower", "upper")) else "fixed"
