"""Contacts with hazards as rows: where on the rover, and whether the lidar could have known."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import NANOSECONDS
from harness.robots import RoverSpec
from harness.samples import PlacedScan, Vector3
from harness.sensors.lidar_spec import scan_points
from harness.truth.traversal import ContactEvent
from harness.tune.episodes.record import EVENT, Sight, Table, Zone
from harness.world.obstacles import Obstacle
from harness.world.world import World

BEFORE_NS, AFTER_NS = 500_000_000, 200_000_000  # around its start: when the hazard should be in sight
NEAR = 0.1  # [m] from the outline within which a return is one of the hazard
BELOW = 0.02  # [m] by which a top must reach above the lidar's plane to be seen for sure


def event_rows(
    events: Sequence[ContactEvent],
    scans: Sequence[PlacedScan],
    speeds: NDArray[np.float16],
    world: World,
    rover: RoverSpec,
) -> Table:
    """Returns the contacts with hazards as a table of dtype EVENT.

    Args:
        events: All contacts of an episode.
        scans: Its scans in order.
        speeds: True forward speed at each of them [m/s], shape (n,).
        world: Where it took place.
        rover: Who drove.
    """
    stamps = np.array([placed.scan.stamp_ns for placed in scans])
    hazards = [event for event in events if event.kind == "hazard"]
    rows = np.zeros(len(hazards), EVENT)
    for row, event in zip(rows, hazards, strict=True):
        first, last = np.searchsorted(
            stamps, (event.start_ns - BEFORE_NS, event.start_ns + AFTER_NS)
        ).tolist()
        before = max(int(np.searchsorted(stamps, event.start_ns)) - 1, 0)
        row["start_s"], row["end_s"] = event.start_ns / NANOSECONDS, event.end_ns / NANOSECONDS
        row["zone"] = _zone(event.point, rover)
        touched = world.obstacles[int(event.other.rsplit("_", 1)[1])]
        row["sight"] = _sight(scans[first:last], touched, rover)
        row["part"], row["force"] = event.part, event.force
        row["speed"] = speeds[before] if speeds.size else 0.0
    return rows


def _zone(point: Vector3, rover: RoverSpec) -> Zone:
    """The side of the rover nearest to a point of the model frame."""
    x, y, _ = point
    x_min, x_max, y_min, y_max = rover.footprint
    sides = {Zone.FRONT: x_max - x, Zone.REAR: x - x_min, Zone.SIDE: min(y_max - y, y - y_min)}
    return min(sides, key=sides.__getitem__)


def _sight(scans: Sequence[PlacedScan], hazard: Obstacle, rover: RoverSpec) -> Sight:
    """What the scans around the start of a contact show of what was touched."""
    if any(_is_on(hazard, scan_points(placed, rover)).any() for placed in scans):
        return Sight.SEEN
    top = hazard.position[2] + hazard.half_size[-1]
    if scans and top < scans[-1].pose.position[2] + rover.lidar_height - BELOW:
        return Sight.TOO_LOW
    if any(np.isneginf(placed.scan.ranges).any() for placed in scans):
        return Sight.TOO_NEAR
    return Sight.MISSED


def _is_on(hazard: Obstacle, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points [m], shape (n, 2), lie within or next to a hazard's outline: shape (n,)."""
    w, _, _, z = hazard.quaternion
    yaw = 2.0 * math.atan2(z, w)
    offset = points - hazard.position[:2]
    along = np.abs(offset @ (math.cos(yaw), math.sin(yaw)))
    across = np.abs(offset @ (-math.sin(yaw), math.cos(yaw)))
    half = hazard.half_size if hazard.shape != "cylinder" else hazard.half_size[:1] * 2
    return np.asarray((along < half[0] + NEAR) & (across < half[1] + NEAR))
