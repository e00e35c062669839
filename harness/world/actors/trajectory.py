"""RoboTerrain's trajectory files, and the <actor>s of SDF files: who walks, through which points."""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

from harness.errors import UsageError
from harness.world.actors.route import LONGEST_ROUTE, Point
from harness.world.sdf.reader import is_true, numbers, read_xml, text_of

SUFFIXES = (".sdf", ".world", ".xml")
# RoboTerrain names its files for the world too: inspect_diag.sdf is of /diag_actor/pose.
AROUND = re.compile(r"^(?:inspect|construct|island|moon|flat)_|_traject(?:ory)?(?=_|$)")


@dataclass(frozen=True, eq=False)
class Told:
    """One person as a file tells.

    Attributes:
        points: x, y, z of the way points in the world [m].
        times: Of an SDF actor's way points [s]; empty in a trajectory alone, where times do not count.
        loops: Whether the script begins anew at its end.
        delay: Before it begins [s].
    """

    name: str
    points: tuple[Point, ...]
    times: tuple[float, ...] = ()
    loops: bool = True
    delay: float = 0.0


def read_told(path: Path) -> tuple[Told, ...]:
    """Returns the people of a file: its actors, or the one whose trajectory it is.

    Raises:
        UsageError: It cannot be read, or nobody walks in it.
    """
    root = read_xml(path)
    if root.tag == "trajectory":
        points, _ = _way_points(root, path)
        return (Told(AROUND.sub("", path.stem), points),)
    people = tuple(_actor(actor, path) for actor in root.iter("actor"))
    if not people:
        raise UsageError(f"{path} has neither a <trajectory> nor an <actor>; name a file with one")
    return people


def _actor(actor: Element, path: Path) -> Told:
    name = actor.get("name", "actor")
    script = actor.find("script")
    x, y, z, _, _, yaw = numbers(text_of(actor, "pose", "0 0 0 0 0 0"), 6, f"{path}: pose of {name}")
    if script is None:
        return Told(name, ((x, y, z),), (0.0,))
    points, times = _way_points(script, path)
    cos, sin = math.cos(yaw), math.sin(yaw)
    placed = tuple((x + cos * a - sin * b, y + sin * a + cos * b, z + c) for a, b, c in points)
    loops = is_true(text_of(script, "loop", "true"))
    (delay,) = numbers(text_of(script, "delay_start", "0"), 1, f"{path}: delay_start of {name}")
    return Told(name, placed, times, loops, delay)


def _way_points(parent: Element, path: Path) -> tuple[tuple[Point, ...], tuple[float, ...]]:
    found = list(parent.iter("waypoint"))
    if not 1 <= len(found) <= LONGEST_ROUTE:
        raise UsageError(f"{path} has {len(found)} way points; give 1 to {LONGEST_ROUTE:,}")
    poses = [numbers(text_of(point, "pose"), 6, f"{path}: way point") for point in found]
    stamps = (numbers(text_of(point, "time", "0"), 1, f"{path}: time") for point in found)
    return tuple(pose[:3] for pose in poses), tuple(time for (time,) in stamps)
