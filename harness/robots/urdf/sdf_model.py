"""What a rover in SDF consists of: links and joints in the frame of its model, also of its parts."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.base.sdf.poses import IDENTITY, Frames, Transform
from harness.base.sdf.reader import is_true, numbers, text_of
from harness.base.sdf.resources import Resources
from harness.base.sdf.scopes import Call, Scopes, framed

MODEL = "__model__"
WORLD = "world"  # as the parent of a joint
OLD = [1, 4]  # the version up to which axes are in the model's frame


@dataclass(frozen=True)
class Link:
    """A link; the pose is in the model, shape (4, 4)."""

    element: Element
    pose: Transform


@dataclass(frozen=True)
class Joint:
    """A joint; pose, shape (4, 4), and axis, shape (3,), are in the model."""

    element: Element
    pose: Transform
    axis: NDArray[np.float64]
    parent: str  # links' names in the model
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


def read_model(root: Element, path: Path, folders: Sequence[Path]) -> Model:
    """Returns the one model of a file that has joints which move.

    Args:
        root: The <sdf>.
        path: Its file.
        folders: With what it includes, beside its own folder and those above.

    Raises:
        UsageError: There is none or more than one, or something in it is not valid.
    """
    notes: list[str] = []
    scopes, world = Scopes(Resources(folders), notes.append), root.find(WORLD)
    calls = scopes.calls(root if world is None else world, (path.resolve(),))
    models = [call for call in calls if call.model.tag == "model"]
    moving = [call for call in models if _moves(call.model)]
    if len(moving) != 1:
        which = "several models" if moving else "no model"
        names = ", ".join(call.name for call in moving or models) or "none at all"
        raise UsageError(f"it holds {which} with joints that move: {names}; give a file of one rover")
    notes.clear()  # of what stands around it
    version = [int(word) for word in root.get("version", "1.6").split(".") if word.isdecimal()]
    model = Model(moving[0].name, notes=notes)
    _Reading(model, scopes, is_old=version <= OLD).scope(moving[0], Frames(MODEL), IDENTITY, ())
    return model


def _moves(model: Element) -> bool:
    return any(joint.get("type") != "fixed" for joint in model.iter("joint"))


class _Reading:
    def __init__(self, model: Model, scopes: Scopes, *, is_old: bool) -> None:
        self._model, self._scopes, self._is_old = model, scopes, is_old

    def scope(self, call: Call, frames: Frames, at: Transform, names: tuple[str, ...]) -> None:
        """Adds what is in a model whose origin is at a pose, within models of these names."""
        calls = [one for one in self._scopes.calls(call.model, call.chain) if one.model.tag == "model"]
        inner = framed(call.model, calls, frames)
        for element in call.model.findall("link"):
            name = element.get("name", "link")
            self._model.links[_joined(*names, name)] = Link(element, at @ frames.find(name))
        for element in call.model.findall("joint"):
            self._joint(element, frames, at, names)
        self._model.plugins += call.model.findall("plugin")
        for one, nested in zip(calls, inner, strict=True):
            pose, reference = one.pose(nested)
            below = names if one.is_merged else (*names, one.name)
            self.scope(one, nested, at @ frames.find(reference) @ pose, below)

    def _joint(self, element: Element, frames: Frames, at: Transform, names: tuple[str, ...]) -> None:
        name, parent = element.get("name", "joint"), text_of(element, "parent")
        if parent == WORLD:
            self._model.notes.append(f"joint '{name}' holds it fast in the world; left out")
            return
        axis = at[:3, :3] @ self._axis(element, name, frames)
        ends = (_joined(*names, link) for link in (parent, text_of(element, "child")))
        self._model.joints[_joined(*names, name)] = Joint(element, at @ frames.find(name), axis, *ends)

    def _axis(self, joint: Element, name: str, frames: Frames) -> NDArray[np.float64]:
        """The axis of a joint in the frame of its model."""
        axis = joint.find("axis")
        xyz = None if axis is None else axis.find("xyz")
        vector = numbers(text_of(axis, "xyz", "0 0 1"), 3, f"<xyz> of joint '{name}'")
        of_model = self._is_old or is_true(text_of(axis, "use_parent_model_frame"))
        stated = "" if xyz is None else xyz.get("expressed_in", "")
        return np.asarray(frames.find(stated or (MODEL if of_model else name))[:3, :3] @ vector)


def _joined(*names: str) -> str:
    return "_".join(names).replace("::", "_")
