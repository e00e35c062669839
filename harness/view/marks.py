"""What is drawn onto the ground of a picture: the driven path, the wheels' tracks, the lidar's beams."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.view.states import States
from harness.world.heightfield import Heightfield

Vector = NDArray[np.float64]

PATH_COLOR = (0.05, 0.78, 0.86, 0.98)  # a hint of transparency: MuJoCo then casts no shadow of it
TRACK_COLOR = (0.27, 0.18, 0.12, 1.0)
BEAM_COLOR = (1.0, 0.25, 0.15, 0.35)
HIT_COLOR = (1.0, 0.12, 0.08, 0.98)
PATH_RADIUS, PATH_SUNK = 0.017, 0.006  # [m]
PATH_SPACING, TRACK_SPACING = 0.06, 0.05  # [m] between marks
MOST_PATH_MARKS = 4000  # beyond, they stand further apart
TRACK_LENGTH = 40.0  # [m] of the path's end that shows the tracks of the wheels
TRACK_HALF_LENGTH, TRACK_HALF_HEIGHT = 0.012, 0.003  # [m] of each lug's imprint
BEAM_WIDTH = 2.0  # [pixels]
MOST_BEAMS = 72  # all around: a line for each of hundreds would hide rover and ground behind a red fan
HIT_RADIUS = 0.018  # [m]


@dataclass(frozen=True, eq=False)
class Mark:
    """One geom that is only to be seen."""

    shape: mujoco.mjtGeom
    size: tuple[float, float, float]
    position: Vector  # of its middle, or of one end [m]
    color: tuple[float, float, float, float]
    frame: Vector = field(default_factory=lambda: np.eye(3))  # its axes as columns, shape (3, 3)
    end: Vector | None = None  # the other end of a capsule or a line [m], whose width is the first size
    since: float = 0.0  # time [s] from which on it is there
    glow: float = 0.0  # how much it shines by itself, 0..1


def add_marks(scene: mujoco.MjvScene, marks: Iterable[Mark], time: float) -> None:
    """Adds marks to a scene, as many as it has room for.

    Args:
        scene: Has been updated.
        marks: In the world; those that are not there yet are left out.
        time: Of the picture [s].
    """
    for mark in marks:
        if mark.since > time:
            continue
        if scene.ngeom >= scene.maxgeom:
            return
        geom = scene.geoms[scene.ngeom]
        color = np.array(mark.color, np.float32)
        mujoco.mjv_initGeom(geom, mark.shape, mark.size, mark.position, mark.frame.ravel(), color)
        if mark.end is not None:
            mujoco.mjv_connector(geom, mark.shape, mark.size[0], mark.position, mark.end)
        geom.emission = mark.glow
        scene.ngeom += 1


def path_marks(recording: States, ground: Heightfield) -> list[Mark]:
    """Returns the driven path as a line on the ground."""
    length = _driven(recording)[-1]
    stations = np.arange(0.0, length, max(PATH_SPACING, length / MOST_PATH_MARKS))
    x, y, _, since = _interpolated(recording, stations)
    points = [_on_ground(ground, *place, above=-PATH_SUNK) for place in zip(x, y, strict=True)]
    shape, size = mujoco.mjtGeom.mjGEOM_CAPSULE, (PATH_RADIUS,) * 3
    return [
        Mark(shape, size, start, PATH_COLOR, end=end, since=time, glow=0.45)
        for start, end, time in zip(points, points[1:], since[1:].tolist(), strict=False)
    ]


def track_marks(recording: States, ground: Heightfield, rover: RoverSpec) -> list[Mark]:
    """Returns the imprints of the lugs along both sides of the path's end.

    Args:
        recording: States of the drive.
        ground: Where they lie.
        rover: Its track and the width of its wheels.
    """
    length = _driven(recording)[-1]
    stations = np.arange(max(0.0, length - TRACK_LENGTH), length, TRACK_SPACING)
    size = (TRACK_HALF_LENGTH, 0.5 * rover.wheel_width, TRACK_HALF_HEIGHT)
    marks = []
    for x, y, yaw, since in zip(*_interpolated(recording, stations), strict=True):
        for side in (0.5 * rover.track, -0.5 * rover.track):
            place = _on_ground(ground, x - side * math.sin(yaw), y + side * math.cos(yaw))
            frame = _lying_frame(ground, place, yaw)
            marks.append(Mark(mujoco.mjtGeom.mjGEOM_BOX, size, place, TRACK_COLOR, frame, since=since))
    return marks


def beam_marks(origin: Vector, directions: Vector, ranges: NDArray[np.float32]) -> list[Mark]:
    """Returns every place that was hit, and of at most MOST_BEAMS beams, evenly spread, the line to it.

    Args:
        origin: Where the lidar is [m].
        directions: Unit vectors in the world, shape (beams, 3).
        ranges: As in LaserScan, shape (beams,).
    """
    # A line, unlike a thin capsule, casts no shadow.
    line, sphere = mujoco.mjtGeom.mjGEOM_LINE, mujoco.mjtGeom.mjGEOM_SPHERE
    stride = -(-len(ranges) // MOST_BEAMS)
    marks = []
    for beam in np.flatnonzero(np.isfinite(ranges)).tolist():
        hit = origin + float(ranges[beam]) * directions[beam]
        marks.append(Mark(sphere, (HIT_RADIUS,) * 3, hit, HIT_COLOR, glow=0.8))
        if beam % stride == 0:
            marks.append(Mark(line, (BEAM_WIDTH,) * 3, origin, BEAM_COLOR, end=hit, glow=1.0))
    return marks


def _driven(recording: States) -> Vector:
    """Length of the path up to each state [m], shape (n,)."""
    steps = np.hypot(*np.diff(recording.path[:, :2], axis=0).T)
    return np.concatenate(([0.0], np.cumsum(steps)))


def _interpolated(recording: States, stations: Vector) -> list[Vector]:
    """x, y [m], yaw [rad] and time [s] at stations along the path [m]."""
    columns = (*recording.path[:, :2].T, recording.yaw, recording.times)
    return [np.interp(stations, _driven(recording), column) for column in columns]


def _on_ground(ground: Heightfield, x: float, y: float, above: float = 0.0) -> Vector:
    return np.array([x, y, ground.height_at(x, y) + above])


def _lying_frame(ground: Heightfield, place: Vector, yaw: float) -> Vector:
    """Axes that lie on the ground: forward, left, up."""
    x, y, reach = place[0], place[1], 0.5 * ground.cell
    slope_x = (ground.height_at(x + reach, y) - ground.height_at(x - reach, y)) / (2.0 * reach)
    slope_y = (ground.height_at(x, y + reach) - ground.height_at(x, y - reach)) / (2.0 * reach)
    up = np.array([-slope_x, -slope_y, 1.0]) / math.hypot(slope_x, slope_y, 1.0)
    left = np.cross(up, (math.cos(yaw), math.sin(yaw), 0.0))
    left /= np.linalg.norm(left)
    return np.column_stack([np.cross(left, up), left, up])
