"""The spaces of what agents observe, part by part, and the ground around a rover as one of the parts."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from harness.drivers.point_nav import limits
from harness.samples import Pose
from harness.sensors.depth import DepthOptions
from harness.world.heightfield import Heightfield
from rover_metrics.core import rotation

Observation = dict[str, NDArray[np.float32]]

AHEAD = tuple(round(-0.5 + 0.2 * n, 3) for n in range(11))  # [m] at which the ground is scanned
LEFT = tuple(round(0.6 - 0.2 * n, 3) for n in range(7))  # [m] to the left at which the ground is scanned
LARGEST_HEIGHT = 2.0  # [m] above or below the rover that is observed


@dataclass(frozen=True)
class Part:
    """One entry of a Dict observation.

    Attributes:
        low: Smallest value of all numbers, or of each.
        high: Largest value of all numbers, or of each.
        about: What it is, with units, for the docs.
        size: Count of numbers, if all have the same limits.
        shape: Of an image; flat if left out.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    about: str
    size: int = 0
    shape: tuple[int, ...] = ()

    def space(self) -> spaces.Box:
        """Returns its space."""
        if self.size:
            return spaces.Box(self.low[0], self.high[0], self.shape or (self.size,), np.float32)
        return spaces.Box(np.array(self.low, np.float32), np.array(self.high, np.float32))


def space_of(parts: Mapping[str, Part]) -> spaces.Dict:
    """Returns the space of an observation of these parts."""
    return spaces.Dict({name: part.space() for name, part in parts.items()})


class Limits:
    """The limits of all numbers of an observation, one after the other: one call keeps them."""

    def __init__(self, space: spaces.Dict) -> None:
        boxes = cast("Mapping[str, spaces.Box]", space.spaces)
        self._low = np.concatenate([box.low.ravel() for box in boxes.values()])
        self._high = np.concatenate([box.high.ravel() for box in boxes.values()])
        ends = np.cumsum([math.prod(box.shape) for box in boxes.values()]).tolist()
        self._images = {name: box.shape for name, box in boxes.items() if len(box.shape) > 1}
        self._parts = dict(zip(boxes, map(slice, [0, *ends], ends), strict=True))

    def keep(self, values: Mapping[str, object]) -> Observation:
        """Returns an observation within its space: float32, parts of a new array."""
        flat = np.empty_like(self._low)
        for name, part in self._parts.items():
            flat[part] = values[name]
        np.maximum(flat, self._low, out=flat)
        np.minimum(flat, self._high, out=flat)
        kept = {name: flat[part] for name, part in self._parts.items()}
        return {**kept, **{name: kept[name].reshape(shape) for name, shape in self._images.items()}}


def heights_around(ground: Heightfield, pose: Pose) -> list[float]:
    """Returns the ground's heights over the rover's model frame [m] at AHEAD x LEFT of it, row by row.

    Obstacles are not in it; the grid turns with the heading, not with roll and pitch.
    """
    x, y, z = pose.position
    yaw = rotation.yaw(pose.orientation)
    cos, sin = math.cos(yaw), math.sin(yaw)
    ahead, left = (axis.ravel() for axis in np.meshgrid(AHEAD, LEFT, indexing="ij"))
    heights = ground.heights_at(x + cos * ahead - sin * left, y + sin * ahead + cos * left)
    return list((heights - z).tolist())


def height_part(*, image: bool = False) -> Part:
    """Returns the heights of `heights_around` as a part of an observation, flat or (ahead, left, 1)."""
    where = f"{AHEAD[0]:g} to {AHEAD[-1]:g} m ahead, {LEFT[0]:g} m left to right, every 0.2 m"
    about = f"heights of the ground without obstacles over the rover [m], {where}"
    shape = (len(AHEAD), len(LEFT), 1) if image else ()
    return Part((-LARGEST_HEIGHT,), (LARGEST_HEIGHT,), about, len(AHEAD) * len(LEFT), shape)


def depth_part(camera: DepthOptions, *, image: bool) -> Part:
    """Returns the image of a depth camera as a part of an observation, flat or (height, width, 1)."""
    about = (
        f"depth image [m] of {camera.width} x {camera.height} pixels, row by row from the top left, "
        f"{math.degrees(camera.fov):.0f} deg wide, from the lidar's place ahead and "
        f"{math.degrees(camera.rpy[1]):.0f} deg down; a miss is the largest"
    )
    shape = (camera.height, camera.width, 1) if image else ()
    return Part((0.0,), (camera.range_max,), about, camera.rays, shape)


def soil_part(wheels: int) -> Part:
    """Returns the part of an observation with what soil does to wheels, as `soil_values` has it."""
    largest = (0.5, math.pi / 2, 500.0, 500.0)
    about = (
        "of each wheel, left side front to rear, then right: sinkage [m]; then slip angles [rad]; pulls "
        "ahead [N]; forces to the left [N]; only a simulator knows them"
    )
    high = tuple(value for value in largest for _ in range(wheels))
    return Part(tuple(-value for value in high), high, about)


def point_nav_parts(beams: int, range_max: float) -> dict[str, Part]:
    """Returns what RoverHarness/PointNav observes with a lidar of that largest range [m]."""
    about = {
        "lidar": "ranges of /scan [m], the first ahead, then counter-clockwise; a miss is the largest",
        "goal": "distance [m], sine, cosine of bearing",
        "imu": "specific force [m/s^2], angular rate [rad/s] along x, y, z, roll, pitch [rad], by IMU",
        "velocities": "speed [m/s], yaw rate [rad/s] of /odometry/wheels",
    }
    ends, sizes = limits(range_max), {"lidar": beams}
    return {name: Part(*ends[name], text, sizes.get(name, 0)) for name, text in about.items()}
