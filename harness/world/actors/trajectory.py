"""RoboTerrain's trajectory files, and the <actor>s of SDF files: who walks, through which points.

Entities are refused and sizes are bounded: such files come from strangers.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from harness.errors import UsageError
from harness.world.actors.route import LONGEST_ROUTE, Point

LARGEST = 50_000_000  # bytes of a file
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
    root = _root(path)
    if root.tag == "trajectory":
        points, _ = _way_points(root, path)
        return (Told(AROUND.sub("", path.stem), points),)
    people = tuple(_actor(actor, path) for actor in root.iter("actor"))
    if not people:
        raise UsageError(f"{path} has neither a <trajectory> nor an <actor>; name a file with one")
    return people


def _root(path: Path) -> ET.Element:
    try:
        if path.stat().st_size > LARGEST:
            raise UsageError(f"{path} is larger than {LARGEST // 1_000_000} MB; take way points out")
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UsageError(f"cannot read the trajectory {path}: {error.strerror}; name another") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path} is not UTF-8 text; save it as such") from error
    if "<!DOCTYPE" in text or "<!ENTITY" in text:  # no entity without either
        raise UsageError(f"{path} defines entities (<!DOCTYPE), which are refused; write it without")
    try:
        return ET.fromstring(text)  # noqa: S314 - see above
    except ET.ParseError as error:
        raise UsageError(f"{path} is not valid XML: {error}") from error


def _actor(actor: ET.Element, path: Path) -> Told:
    name = actor.get("name", "actor")
    script = actor.find("script")
    x, y, z, _, _, yaw = _numbers(actor.findtext("pose") or "0 0 0 0 0 0", 6, path)
    if script is None:
        return Told(name, ((x, y, z),), (0.0,))
    points, times = _way_points(script, path)
    cos, sin = math.cos(yaw), math.sin(yaw)
    placed = tuple((x + cos * a - sin * b, y + sin * a + cos * b, z + c) for a, b, c in points)
    loops = (script.findtext("loop") or "true").strip().lower() in ("true", "1")
    (delay,) = _numbers(script.findtext("delay_start") or "0", 1, path)
    return Told(name, placed, times, loops, delay)


def _way_points(parent: ET.Element, path: Path) -> tuple[tuple[Point, ...], tuple[float, ...]]:
    found = list(parent.iter("waypoint"))
    if not 1 <= len(found) <= LONGEST_ROUTE:
        raise UsageError(f"{path} has {len(found)} way points; give 1 to {LONGEST_ROUTE:,}")
    poses = [_numbers(point.findtext("pose") or "", 6, path) for point in found]
    times = [_numbers(point.findtext("time") or "0", 1, path)[0] for point in found]
    return tuple(pose[:3] for pose in poses), tuple(times)


def _numbers(text: str, count: int, path: Path) -> tuple[float, ...]:
    try:
        values = tuple(map(float, text.split()))
    except ValueError:
        values = ()
    if len(values) != count or not all(map(math.isfinite, values)):
        raise UsageError(f"{path}: '{' '.join(text.split())[:60]}' is not {count} finite numbers")
    return values
