"""An SDF file -> its document.

Models stay where their poses put them: collisions are solids whether their model is static or not, but
a model with joints that move is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from harness.base.errors import UsageError
from harness.base.sdf.poses import IDENTITY, Frames, Transform, inverse, read_pose
from harness.base.sdf.reader import color_of, numbers, read_list, text_of
from harness.base.sdf.resources import Missing, Resources
from harness.base.sdf.scopes import Call, Scopes, framed
from harness.spec.world import GRAVITY
from harness.world.obstacles import Color
from harness.world.sdf.document import Document, Person
from harness.world.sdf.geometry import read_shapes
from harness.world.solid import Primitive, Solid

MOST_SOLIDS = 20_000
ON_EARTH = ("latitude_deg", "longitude_deg", "elevation")
EARTH = "0 0 -9.8"  # SDF's default
NEAR = 1e-3  # [m]: a model that has settled as little is where it was


def read_document(path: Path, resources: Resources) -> Document:
    """Reads a world, or a model alone; UsageError if it or a file that it includes is not valid."""
    document = Document()
    _Reading(document, resources).file(path)
    return document


@dataclass(frozen=True)
class _Place:
    """Where an element stands: T_world_scope, the names around it, and the files that led there."""

    pose: Transform
    names: tuple[str, ...]
    chain: tuple[Path, ...]
    is_static: bool = False

    def within(self, name: str, pose: Transform) -> "_Place":
        return replace(self, pose=self.pose @ pose, names=(*self.names, name))


class _Reading:
    def __init__(self, document: Document, resources: Resources) -> None:
        self._document, self._resources = document, resources
        self._scopes = Scopes(resources, self._left_out)
        document.files = self._scopes.files

    def file(self, path: Path) -> None:
        models = read_list(path)
        if models is None:
            root = self._scopes.root(path)
        else:
            root = models
            self._scopes.files.append(path)
        world = root.find("world")
        place = _Place(IDENTITY, (), (path.resolve(),))
        if world is None:
            world = root
            if not any(root.find(tag) is not None for tag in ("model", "actor", "include")):
                raise UsageError(f"{path}: it has neither <world> nor <model>; that is no world")
        if root.findall("world")[1:]:
            self._left_out("all worlds of the file but the first")
        gravity = numbers(text_of(world, "gravity", EARTH), 3, "gravity")
        if gravity[0] or gravity[1] or not GRAVITY[0] <= -gravity[2] <= GRAVITY[1]:
            raise UsageError(
                f"{path}: gravity {gravity} is not straight down, or not {GRAVITY[0]:g} to "
                f"{GRAVITY[1]:g} m/s^2; rovers drive on nothing else"
            )
        self._document.gravity = -gravity[2]
        where = [text_of(world.find("spherical_coordinates"), tag, "0") for tag in ON_EARTH]
        if any(word.strip("-+.0") for word in where):
            self._left_out(f"<spherical_coordinates>; --datum {','.join(where)} says the same")
        self._document.restored += _restore(world)
        self._scope(world, Frames("world"), place)
        if world is root:
            several = models is not None or sum(item.tag in ("model", "include") for item in root) > 1
            plain = all(isinstance(solid.shape, Primitive) for solid in self._document.solids)
            self._document.is_loose = several or plain

    def _left_out(self, name: str) -> None:
        self._document.missing.setdefault(name)

    def _scope(self, scope: Element, frames: Frames, place: _Place) -> None:
        """Reads what stands in a world or in a model: first all frames, then what is in them."""
        for plugin in scope.findall("plugin"):
            self._document.plugins.setdefault(plugin.get("name") or plugin.get("filename") or "?")
        for tag in ("population", "road"):
            if scope.find(tag) is not None:
                self._left_out(f"<{tag}>")
        calls = self._scopes.calls(scope, place.chain)
        inner = framed(scope, calls, frames)
        for link in scope.findall("link"):
            self._link(link, frames, place)
        for call, nested in zip(calls, inner, strict=True):
            pose, reference = call.pose(nested)  # not by its name, which another may have too
            at = place.within(call.name, frames.find(reference) @ pose)
            if call.model.tag == "actor":
                self._actor(call, at)
            else:
                self._model(call, nested, replace(at, chain=call.chain))

    def _actor(self, call: Call, at: _Place) -> None:
        if call.model.find("script/trajectory") is None and call.model.find("plugin") is not None:
            self._left_out(f"the plugin that steers actor '{call.name}', who stands still")
        person = Person(call.name, call.model, at.pose, call.chain[-1])
        self._document.actors.append(person)

    def _model(self, call: Call, frames: Frames, place: _Place) -> None:
        is_static = place.is_static or call.is_static
        if not is_static and call.model.tag == "model":
            joints = {joint.get("type") for joint in call.model.findall("joint")}
            if joints - {"fixed"}:
                self._left_out(f"model '{'::'.join(place.names)}': it has joints that move")
                return
            self._document.movable.append("::".join(place.names))
            is_static = True  # noted once, not for its parts
        self._scope(call.model, frames, replace(place, is_static=is_static))

    def _link(self, link: Element, frames: Frames, place: _Place) -> None:
        name = link.get("name", "link")
        at = place.within(name, frames.find(name))
        color = next(filter(None, map(color_of, link.findall("visual"))), None)
        for collision in link.findall("collision"):
            self._document.solids += self._solids(collision, frames, at, color)
        if len(self._document.solids) > MOST_SOLIDS:
            raise UsageError(f"more than {MOST_SOLIDS} collisions; take some out")

    def _solids(
        self, collision: Element, frames: Frames, link: _Place, color: Color | None
    ) -> Sequence[Solid]:
        name = "::".join((*link.names, collision.get("name", collision.tag)))
        pose, reference = read_pose(collision, name)
        geometry = collision.find("geometry")
        if geometry is None:
            self._left_out(f"{name}: it has no <geometry>")
            return ()
        try:
            shapes = read_shapes(geometry, name, link.chain[-1], self._resources)
        except Missing as missing:
            self._left_out(str(missing))
            return ()
        if reference:  # of the model that the link is in
            own = link.pose @ inverse(frames.find(link.names[-1])) @ frames.find(reference) @ pose
        else:
            own = link.pose @ pose
        mu = text_of(collision.find("surface/friction/ode"), "mu")
        friction = numbers(mu, 1, f"<mu> of {name}")[0] if mu else None
        if friction is not None and friction < 0.0:
            raise UsageError(f"<mu> of {name} '{mu}' is not valid; give 0 or more")
        return [Solid(name, shape, own @ at, friction, color) for shape, at in shapes]


def _restore(world: Element) -> list[str]:
    """Puts models where the world's <state> says, as Gazebo classic does; returns their names.

    Gazebo classic adds it to a world that it saves; later ones neither write nor read any.
    """
    models, moved = {model.get("name"): model for model in world.findall("model")}, []
    for state in world.findall("state/model"):
        name, pose = state.get("name", ""), state.find("pose")
        model = models.get(name)
        if model is None or pose is None:
            continue
        if not np.allclose(read_pose(state, name)[0], read_pose(model, name)[0], atol=NEAR):
            for old in model.findall("pose"):
                model.remove(old)
            model.append(pose)
            moved.append(name)
    return moved
