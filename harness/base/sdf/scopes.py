"""What stands in a scope of SDF, a world or a model: its own models and actors, and included ones."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

from harness.base.errors import UsageError
from harness.base.sdf.poses import IDENTITY, Frames, Transform, inverse, read_pose
from harness.base.sdf.reader import is_true, text_of
from harness.base.sdf.resources import Missing, Resources, model_file, of_gazebo
from harness.base.xml import read_xml

MOST_INCLUDES = 2_000
ROOTS = ("sdf", "gazebo")  # as it is called, and was before version 1.3


@dataclass(frozen=True)
class Call:
    """A model or an actor in a scope: its own element, and that of the include that it comes by.

    A whole file can be included too: its <world>, or all of it where actors stand beside a model.
    """

    model: Element
    include: Element | None
    chain: tuple[Path, ...]  # the files that led there, each including the next
    version: str = ""  # of SDF, of the last of them; "" if nobody says

    @property
    def name(self) -> str:
        """What it is called in its scope."""
        return text_of(self.include, "name", self.model.get("name", self.model.tag))

    @property
    def is_static(self) -> bool:
        """Whether it is said to stand fast."""
        return is_true(text_of(self.include, "static", text_of(self.model, "static")))

    @property
    def is_merged(self) -> bool:
        """Whether what is in it counts as part of the model that includes it."""
        return self.include is not None and is_true(self.include.get("merge", ""))

    def pose(self, frames: Frames) -> tuple[Transform, str]:
        """Returns the pose of its origin, and in which frame; the include's comes before its own."""
        source = self.include
        if source is None or source.find("pose") is None:
            source = self.model
        pose, reference = read_pose(source, self.name)
        placement = text_of(self.include, "placement_frame", self.model.get("placement_frame", ""))
        return pose @ inverse(frames.find(placement)), reference


class Scopes:
    """Reads files of SDF and finds what stands in their scopes.

    Args:
        resources: Where included files are.
        left_out: Is told what cannot be had.

    Attributes:
        files: Those that were read.
    """

    def __init__(self, resources: Resources, left_out: Callable[[str], object]) -> None:
        self.files: list[Path] = []
        self._resources, self._left_out, self._includes = resources, left_out, 0

    def root(self, path: Path) -> Element:
        """Returns the root of a file; UsageError if it is no <sdf>."""
        root = read_xml(path)
        if root.tag not in ROOTS:
            raise UsageError(f"{path}: its root is <{root.tag}>, not <sdf>")
        self.files.append(path)
        return root

    def calls(self, scope: Element, chain: tuple[Path, ...], version: str = "") -> list[Call]:
        """Returns the models and actors of a scope, its own before those that it includes.

        Args:
            scope: The element.
            chain: The files that led there; the last one holds it.
            version: Of SDF, of the last one.

        Raises:
            UsageError: A file includes itself or is not valid, or there are too many.
        """
        calls = [Call(item, None, chain, version) for item in scope if item.tag in ("model", "actor")]
        for include in scope.findall("include"):
            calls += self._included(include, chain)
        return calls

    def _included(self, include: Element, chain: tuple[Path, ...]) -> list[Call]:
        uri = text_of(include, "uri")
        try:
            path = model_file(self._resources.find(uri, chain[-1]))
        except Missing as missing:
            brought = of_gazebo(uri)
            if brought is None:
                self._left_out(str(missing))
            return [Call(item, include, chain) for item in brought or ()]
        below = (*chain, path.resolve())
        if path.resolve() in chain:
            circle = " -> ".join(file.name for file in below)
            raise UsageError(f"{path} includes itself: {circle}; take one <include> out")
        self._includes += 1
        if self._includes > MOST_INCLUDES:
            raise UsageError(f"more than {MOST_INCLUDES} includes; take some out")
        if any(item.tag.endswith(":params") for item in include):
            self._left_out(f"changes by <experimental:params> of {uri}")
        root = self.root(path)
        return [Call(item, include, below, root.get("version", "")) for item in _entities(root)]


def framed(scope: Element, calls: Sequence[Call], frames: Frames) -> list[Frames]:
    """Returns the frames within each call of a scope, and adds the scope's own to its `frames`."""
    inner = [Frames("world" if call.model.tag == "world" else "__model__") for call in calls]
    for call, nested in zip(calls, inner, strict=True):
        _add(call.model, nested)
        frames.add(call.name, *call.pose(nested))
        frames.nest(call.name, nested)
        if call.is_merged:
            for name in nested.names:
                frames.add(name, IDENTITY, f"{call.name}::{name}")
    _add(scope, frames)
    return inner


def _add(scope: Element, frames: Frames) -> None:
    """Adds the links, joints and free frames of a model or world."""
    for link in scope.findall("link"):
        frames.add(link.get("name", "link"), *read_pose(link, link.get("name", "link")))
    for frame in scope.findall("frame"):
        pose, reference = read_pose(frame, frame.get("name", "frame"))
        frames.add(frame.get("name", ""), pose, reference or frame.get("attached_to", ""))
    for joint in scope.findall("joint"):
        pose, reference = read_pose(joint, joint.get("name", "joint"))
        frames.add(joint.get("name", ""), pose, reference or text_of(joint, "child"))


def _entities(root: Element) -> list[Element]:
    """What an include of a file brings: a model, an actor or a world; or all, where actors are more."""
    models, actors, world = root.findall("model")[:1], root.findall("actor"), root.find("world")
    if world is not None:
        return [world]
    return [root] if len(models) + len(actors) > 1 else [*models, *actors]
