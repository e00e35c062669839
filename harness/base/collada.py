"""What COLLADA files say of themselves beside their triangles: unit, axis, how many shapes there are."""

from xml.etree.ElementTree import Element

import numpy as np

from harness.base.errors import UsageError
from harness.base.xml import DEEPEST, parse_xml
from rover_metrics.number import number

MOST_SHAPES = 5_000  # of a scene, each as often as it stands there
# What axis is up in a file -> R_world_file, as COLLADA defines its three.
UP = {
    "z": np.eye(3),
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "x": np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]),
}


def unit_and_axis(data: bytes) -> tuple[float, str]:
    """Returns the length of a file's unit [m] and its axis that is up, one of UP.

    Raises:
        UsageError: It is no XML, what it says is not valid, or its scene has more than MOST_SHAPES.
    """
    root = parse_xml(data)
    _check_shapes(root)
    asset = {_tag(element): element for element in next((e for e in root if _tag(e) == "asset"), ())}
    up = (asset["up_axis"].text or "") if "up_axis" in asset else "Y_UP"  # COLLADA's default
    text = asset["unit"].get("meter", "1") if "unit" in asset else "1"
    try:
        unit = number(text)
    except ValueError:
        unit = 0.0
    if not 0.0 < unit < 1e6:
        raise UsageError(f"its unit of {text} m is not valid; give a length in metres")
    axis = up.strip().lower().removesuffix("_up")
    if axis not in UP:
        raise UsageError(f"its up_axis '{up.strip()}' is not valid; COLLADA has X_UP, Y_UP and Z_UP")
    return unit, axis


def _tag(element: Element) -> str:
    return element.tag.rpartition(":")[2]  # expat leaves prefixes as they are


def _check_shapes(root: Element) -> None:
    """Counts the shapes of COLLADA scenes, in which nodes stand in other nodes as often as they like."""
    nodes = {element.get("id", ""): element for element in root.iter() if _tag(element) == "node"}
    known: dict[str, int] = {}

    def count(element: Element, depth: int) -> int:
        if depth > DEEPEST:
            raise UsageError(f"its nodes stand in themselves, or more than {DEEPEST} in each other")
        total = 0
        for child in element:
            if _tag(child) == "node":
                total += count(child, depth + 1)
            elif _tag(child) == "instance_node" and (url := child.get("url", "")[1:]) in nodes:
                if url not in known:
                    known[url] = count(nodes[url], depth + 1)
                total += known[url]
            total += _tag(child) in ("instance_geometry", "instance_controller")
        return total

    shapes = sum(count(element, 0) for element in root.iter() if _tag(element) == "visual_scene")
    if shapes > MOST_SHAPES:
        raise UsageError(f"its scene has {shapes:,} shapes; at most {MOST_SHAPES:,} are read: join them")
