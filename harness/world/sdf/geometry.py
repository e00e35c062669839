"""SDF's <geometry> -> shapes: a capsule is three, a polyline none."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from harness.base.errors import UsageError
from harness.base.sdf.poses import IDENTITY, Transform, transform
from harness.base.sdf.reader import is_true, numbers, text_of
from harness.base.sdf.resources import Missing, Resources
from harness.world.solid import MeshFile, Plane, Primitive, Relief, Shape

Placed = tuple[Shape, Transform]  # and where it is in the frame of its geometry

LARGEST_SIZE = 1e5  # [m]


def read_shapes(geometry: Element, owner: str, file: Path, resources: Resources) -> list[Placed]:
    """Returns the shapes of a <geometry>; Missing if they cannot be had, UsageError for a wrong number.

    Args:
        geometry: The element.
        owner: The collision that has it, for messages.
        file: The file that it stands in.
        resources: Where its own files are.
    """
    kind = next((child for child in geometry), None)
    if kind is None or kind.tag == "empty":
        return []
    if kind.tag not in READERS:
        raise Missing(f"shapes of the kind <{kind.tag}>")
    shape = READERS[kind.tag](kind, owner, file, resources)
    if kind.tag != "capsule":
        return [(shape, IDENTITY)]
    radius, half = shape.half_size
    ends = (transform((0.0, 0.0, end), IDENTITY[:3, :3]) for end in (half, -half))
    return [(shape, IDENTITY), *((Primitive("ellipsoid", (radius,) * 3), end) for end in ends)]


def _primitive(kind: Element, owner: str, *_: object) -> Primitive:
    """A box, sphere or ellipsoid; or the cylinder, which a capsule has too."""
    match kind.tag:
        case "box":
            return Primitive("box", tuple(0.5 * length for length in _lengths(kind, "size", 3, owner)))
        case "sphere":
            return Primitive("ellipsoid", _lengths(kind, "radius", 1, owner) * 3)
        case "ellipsoid":
            return Primitive("ellipsoid", _lengths(kind, "radii", 3, owner))
    (radius,), (length,) = (_lengths(kind, tag, 1, owner) for tag in ("radius", "length"))
    return Primitive("cylinder", (radius, 0.5 * length))


def _plane(kind: Element, owner: str, *_: object) -> Shape:
    x, y, z = numbers(text_of(kind, "normal", "0 0 1"), 3, f"normal of {owner}")
    if not math.hypot(x, y, z):
        raise UsageError(f"normal of {owner} is 0; give a direction, as 0 0 1")
    width, depth = _lengths(kind, "size", 2, owner, "100 100")  # of what has no end
    return Plane((x, y, z), (width, depth))


def _heightmap(kind: Element, owner: str, file: Path, resources: Resources) -> Shape:
    path = resources.find(text_of(kind, "uri"), file)
    x, y, z = numbers(text_of(kind, "pos", "0 0 0"), 3, f"pos of {owner}")
    if not text_of(kind, "size"):
        return Relief(path, None, (x, y, z))
    width, depth, height = _lengths(kind, "size", 3, owner)
    return Relief(path, (width, depth, height), (x, y, z))


def _mesh(kind: Element, owner: str, file: Path, resources: Resources) -> Shape:
    x, y, z = numbers(text_of(kind, "scale", "1 1 1"), 3, f"<scale> of {owner}")
    if not all(1e-6 <= abs(factor) <= 1e6 for factor in (x, y, z)):
        raise UsageError(
            f"<scale> of {owner} is not valid; a factor is 0, or not a millionth to a million"
        )
    submesh = kind.find("submesh")
    name, centred = text_of(submesh, "name"), is_true(text_of(submesh, "center"))
    return MeshFile(resources.find(text_of(kind, "uri"), file), (x, y, z), name, centred)


READERS: dict[str, Callable[..., Any]] = {
    **dict.fromkeys(("box", "sphere", "ellipsoid", "cylinder", "capsule"), _primitive),
    "plane": _plane,
    "mesh": _mesh,
    "heightmap": _heightmap,
}


def _lengths(element: Element, tag: str, count: int, owner: str, default: str = "") -> tuple[float, ...]:
    text = text_of(element, tag, default)
    values = numbers(text, count, f"<{tag}> of {owner}")
    if not all(0.0 < value <= LARGEST_SIZE for value in values):
        raise UsageError(f"<{tag}> of {owner} '{text}' is not valid; give metres above 0, up to 100 km")
    return values
