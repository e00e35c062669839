"""A tree of frames by their names: each has one parent, and all hang together below one root."""

from collections.abc import Iterable
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter

from harness.base.errors import UsageError
from harness.samples import Quaternion, Vector3

ODOM, MAP = "odom", "map"
FOOTPRINT = "base_footprint"  # of every rover: /odom_ground_truth has its pose, as in RoboTerrain


@dataclass(frozen=True)
class Edge:
    """A frame in its parent: translation [m] and rotation (x, y, z, w) of T_parent_child."""

    parent: str
    child: str
    translation: Vector3 = (0.0, 0.0, 0.0)
    rotation: Quaternion = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Description:
    """What is published of a rover once, before its first tick."""

    fixed: tuple[Edge, ...]  # the frames that do not move in their parents
    # parent and child of each pose in a sample of transforms; one that has fewer has the first of them
    moving: tuple[tuple[str, str], ...]
    owns_odom: bool  # whether the first of them is the rover in the frame odom
    urdf: str  # the robot description


def check_tree(root: str, edges: Iterable[tuple[str, str]], where: object) -> None:
    """Checks that every frame has one parent and hangs below the root.

    Args:
        root: The frame that has no parent.
        edges: Parent and child of each other frame.
        where: The file, for the message.

    Raises:
        UsageError: A frame has two parents or none that exists, or some hang in a loop; it names them.
    """
    parent_of: dict[str, str] = {}
    for parent, child in edges:
        if child in parent_of:
            one, two = parent_of[child], parent
            raise UsageError(f"{where}: frame '{child}' has two parents, {one} and {two}; leave one out")
        if child == root:
            mend = f"leave out {parent}"
            raise UsageError(f"{where}: frame '{root}' is the base and has no parent; {mend}")
        parent_of[child] = parent
    known = (root, *parent_of)
    for child, parent in parent_of.items():
        if parent not in known:
            fault = f"frame '{child}' has the parent '{parent}', which does not exist"
            raise UsageError(f"{where}: {fault}; available: {', '.join(known)}")
    try:
        TopologicalSorter({child: [parent] for child, parent in parent_of.items()}).prepare()
    except CycleError as error:
        loop = " -> ".join(error.args[1])
        raise UsageError(f"{where}: frames hang in a loop, {loop}; let one hang on '{root}'") from error
