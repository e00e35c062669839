"""What a rover in SDF consists of: links and joints in the frame of its model, also of its parts."""

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.base.sdf.poses import IDENTITY, Frames, Transform, read_pose
from harness.base.sdf.reader import is_true, numbers, text_of
from harness.base.sdf.resources import Resources
from harness.base.sdf.scopes import Call, Scopes, framed
from harness.base.xml import parse_xml
from harness.robots.urdf.equipment import SIDE_JOINT
from harness.robots.urdf.joints import TRACKS

MODEL = "__model__"
WORLD = "world"  # as the parent of a joint
OLD = [1, 4]  # the version up to which axes are in the model's frame
Of = TypeVar("Of", "Link", "Joint")
TWO_AXES = "universal", "revolute2"
CROSS = parse_xml(  # of what is between their axes, where SDF has no link
    b"<inertial><mass>0.01</mass><inertia><ixx>1e-5</ixx><iyy>1e-5</iyy><izz>1e-5</izz></inertia></inertial>"
)
USUAL = "1.6"  # the version of a file that does not tell


@dataclass(frozen=True)
class Link:
    """A link; its pose, and that of the model in which it is, are in the rover, shape (4, 4)."""

    element: Element
    pose: Transform
    frames: Frames  # of its model
    model: Transform

    def at(self, part: Element | None, owner: str) -> Transform:
        """Returns the pose in the rover of what is in the link, called so in messages."""
        pose, reference = (IDENTITY, "") if part is None else read_pose(part, owner)
        return (self.model @ self.frames.find(reference) if reference else self.pose) @ pose


@dataclass(frozen=True)
class Joint:
    """A joint; pose, shape (4, 4), and axis, shape (3,), are in the rover, as those of links are."""

    element: Element
    pose: Transform
    axis: NDArray[np.float64]
    parent: str  # links' names in the rover
    child: str

    @property
    def kind(self) -> str:
        """Its type; one that turns a part which hangs loose, as the ball of a caster, is `ball`."""
        return self.element.get("type", "")


@dataclass
class Model:
    """A rover; the names of links and joints begin with those of the parts that have them."""

    name: str
    links: dict[str, Link] = field(default_factory=dict)
    joints: dict[str, Joint] = field(default_factory=dict)
    plugins: list[Element] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # what could not be had, a line each


def read_model(root: Element, path: Path, folders: Sequence[Path], name: str) -> Model:
    """Returns the one model of a file that has joints which move, or that of a name among several.

    Args:
        root: The <sdf>.
        path: Its file.
        folders: With what it includes, beside its own folder and those above.
        name: The rover's.

    Raises:
        UsageError: There is none or more than one, or something in it is not valid.
    """
    notes: list[str] = []
    scopes, world = Scopes(Resources(folders), notes.append), root.find(WORLD)
    version = root.get("version", USUAL)
    calls = scopes.calls(root if world is None else world, (path.resolve(),), version)
    models = [call for call in calls if call.model.tag == "model"]
    moving = [call for call in models if _moves(call, scopes)]
    moving = [call for call in moving if call.name == name] or moving
    moving = [call for call in moving if not call.is_static] or moving  # as tutorials leave it
    if len(moving) != 1:
        mend = "call the rover as one of them" if moving else f"give a file of a rover; {TRACKS}"
        which = "several models" if moving else "no model"
        names = ", ".join(call.name for call in moving or models) or "none at all"
        raise UsageError(f"it holds {which} with joints that move: {names}; {mend}")
    notes.clear()  # of what stands around it
    model = Model(moving[0].name, notes=notes)
    reading = _Reading(model, scopes)
    reading.scope(moving[0], Frames(MODEL), IDENTITY, ())
    for called, joint in model.joints.items():
        tied = reading.link_of(joint.parent), reading.link_of(joint.child)
        model.joints[called] = replace(joint, parent=tied[0], child=tied[1])
    return model


def _moves(call: Call, scopes: Scopes) -> bool:
    """Whether a model, or one that is in it, has joints that move."""
    if any(joint.get("type") != "fixed" for joint in call.model.findall("joint")):
        return True
    return any(_moves(one, scopes) for one in scopes.calls(call.model, call.chain, call.version))


def _is_old(version: str) -> bool:
    return [int(word) for word in (version or USUAL).split(".") if word.isdecimal()] <= OLD


class _Reading:
    def __init__(self, model: Model, scopes: Scopes) -> None:
        self._model, self._scopes = model, scopes
        self._attached: dict[str, str] = {}  # frames, joints and models, to what

    def link_of(self, name: str) -> str:
        """Returns the link to which what is called so in the rover is attached; its name if to none."""
        for _ in self._attached:
            if name in self._model.links:
                break
            name = self._attached.get(name, name)
        return name

    def scope(self, call: Call, frames: Frames, at: Transform, names: tuple[str, ...]) -> None:
        """Adds what is in a model whose origin is at a pose, within models of these names."""
        calls = self._scopes.calls(call.model, call.chain, call.version)
        calls = [one for one in calls if one.model.tag == "model"]
        inner = framed(call.model, calls, frames)
        for element in call.model.findall("link"):
            name = element.get("name", "link")
            link = Link(element, at @ frames.find(name), frames, at)
            _add(self._model.links, _joined(*names, name), link)
        parts = [_own(one) if one.is_merged else one.name for one in calls]
        self._attach(call.model, parts, names, _own(call))
        for element in call.model.findall("joint"):
            self._joint(element, frames, at, names, is_old=_is_old(call.version))
        self._model.plugins += [_named(plugin, names) for plugin in call.model.findall("plugin")]
        for one, nested in zip(calls, inner, strict=True):
            pose, reference = one.pose(nested)
            below = names if one.is_merged else (*names, one.name)
            self.scope(one, nested, at @ frames.find(reference) @ pose, below)

    def _attach(self, model: Element, parts: Sequence[str], names: tuple[str, ...], own: str) -> None:
        """Notes what the frames and joints of a model are attached to, and which link is its `own`."""
        links = [link.get("name", "link") for link in model.findall("link")]
        to = {own: model.get("canonical_link") or next(iter((*links, *parts)), "")}
        stated = {one.get("name", ""): one.get("attached_to") or MODEL for one in model.findall("frame")}
        to |= {name: own if other == MODEL else other for name, other in stated.items()}
        to |= {joint.get("name", ""): text_of(joint, "child") for joint in model.findall("joint")}
        for name, other in to.items():
            self._attached.setdefault(_joined(*names, name), _joined(*names, other))
        if names:
            self._attached.setdefault(_joined(*names), _joined(*names, MODEL))

    def _joint(
        self, element: Element, frames: Frames, at: Transform, names: tuple[str, ...], *, is_old: bool
    ) -> None:
        if element.get("type") in TWO_AXES:
            for one in self._parted(element, frames, at, names):
                self._joint(one, frames, at, names, is_old=is_old)
            return
        name, parent = element.get("name", "joint"), text_of(element, "parent")
        if parent == WORLD:
            self._model.notes.append(f"joint '{name}' holds it fast in the world; left out")
            return
        child = text_of(element, "child")
        pose, reference = read_pose(element, name)  # not by its name, which a link may have too
        pose = frames.find(reference or child) @ pose
        axis = element.find("axis")
        xyz = None if axis is None else axis.find("xyz")
        vector = numbers(text_of(axis, "xyz", "0 0 1"), 3, f"<xyz> of joint '{name}'")
        of_model = is_old or is_true(text_of(axis, "use_parent_model_frame"))
        stated = "" if xyz is None else xyz.get("expressed_in", "")
        frame = frames.find(stated or MODEL) if stated or of_model else pose
        turned = np.asarray((at @ frame)[:3, :3] @ vector)
        ends = (_joined(*names, link) for link in (parent, child))
        joint = Joint(_named(element, names), at @ pose, turned, *ends)
        _add(self._model.joints, _joined(*names, name), joint)

    def _parted(
        self, element: Element, frames: Frames, at: Transform, names: tuple[str, ...]
    ) -> tuple[Element, Element]:
        """A joint of two axes as two joints, NAME and NAME_2, and a light link NAME_cross between."""
        name, child = element.get("name", "joint"), text_of(element, "child")
        if element.find("axis2") is None:
            raise UsageError(f"joint '{name}' is '{element.get('type')}' without an <axis2>; add it")
        first, second = deepcopy(element), deepcopy(element)
        cross = Element("link", name=f"{name}_cross")
        cross.append(deepcopy(CROSS))
        pose, reference = read_pose(element, name)
        link = Link(cross, at @ frames.find(reference or child) @ pose, frames, at)
        _add(self._model.links, _joined(*names, f"{name}_cross"), link)
        for one, tag, end in ((first, "axis2", "child"), (second, "axis", "parent")):
            one.set("type", "revolute")
            for item in [*one.findall(tag), *one.findall(end)]:
                one.remove(item)
            SubElement(one, end).text = f"{name}_cross"
        for item in second.findall("axis2"):
            item.tag = "axis"
        second.set("name", f"{name}_2")
        if (stated := first.find("pose")) is None:
            stated = SubElement(first, "pose")
        # A pose without that would be in the frame of the cross.
        stated.set("relative_to", reference or child)
        return first, second


def _add(known: dict[str, Of], name: str, one: Of) -> None:
    """Adds a link or a joint; UsageError where another one has its name."""
    if name in known:
        raise UsageError(f"two {type(one).__name__.lower()}s are called '{name}'; rename one")
    known[name] = one


def _named(element: Element, names: tuple[str, ...]) -> Element:
    """A copy of a joint or a plugin that names other joints as they are named in the rover."""
    copy = deepcopy(element)
    for item in copy.iter():
        if item.tag == "mimic":
            item.set("joint", _joined(*names, item.get("joint", "")))
        elif SIDE_JOINT.fullmatch(item.tag):
            item.text = _joined(*names, (item.text or "").strip())
    return copy


def _joined(*names: str) -> str:
    return "_".join(names).replace("::", "_")


def _own(call: Call) -> str:
    """What the frame of a model is called; of one that is merged, where the including one's is MODEL."""
    return f"{MODEL} of {call.name}" if call.is_merged else MODEL
