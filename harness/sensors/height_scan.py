"""A height scan: the ground and the obstacles around the rover as a grid of heights, without errors.

What a learner sees of the terrain, and what an elevation map of perfect sensors would hold. Heights are
those of what is met first from above; moving obstacles are where they are now.
"""

import math
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass
from typing import ClassVar, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from harness.robots import RoverSpec
from harness.robots.sections import FrameRow
from harness.sensors.optional import Installation, OptionalSensor, Rate, SensorOptions
from harness.spec.value import Length

ROVER: Final = "rover"  # ahead and left of the rover
WORLD: Final = "world"  # x and y of the world
ABOVE = 1.0  # [m] over the highest obstacle, from where is looked down
MOST_CELLS = 250_000
DOWN = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True, slots=True)
class HeightScan:
    """Heights around the rover; x, y, z is the grid's middle in the world [m]."""

    stamp_ns: int
    sensor: str
    # of the cells' middles over that one [m], shape (cells along the first axis, along the second), each
    # from the lowest coordinate up; NaN off the map
    heights: NDArray[np.float32]
    x: float
    y: float
    z: float
    yaw: float  # from the world's x axis to the grid's first one [rad]


class HeightScanOptions(SensorOptions):
    """Options of a height scan; without a parent it is mounted on the rover's base.

    Attributes:
        preset: Name of values of the others.
        size: Lengths along the grid's first and second axis [m]; at least a cell each.
        resolution: Side length of a cell [m].
        axes: `rover`: the grid turns with the rover's heading; `world`: it does not.
        grid_map: Whether it is published; the samples are there without.
    """

    presets: ClassVar[Mapping[str, Mapping[str, object]]] = {
        "grid_map": {"grid_map": True, "axes": WORLD}
    }

    preset: str = ""
    rate: Rate = 20
    size: tuple[Length, Length] = (2.0, 2.0)
    resolution: Length = 0.1
    axes: Literal["rover", "world"] = ROVER
    grid_map: bool = False

    def frames(self, rover: RoverSpec) -> tuple[FrameRow, ...]:
        """Returns the frame that it adds to those of a rover."""
        parent = self.parent or rover.odometry_child_frame
        return (FrameRow(parent=parent, child=self.frame_id, xyz=self.xyz, rpy=self.rpy),)

    @property
    def cells(self) -> tuple[int, ...]:
        """Returns the number of cells along each axis."""
        return tuple(max(1, round(length / self.resolution)) for length in self.size)

    @model_validator(mode="after")
    def _check_cells(self) -> Self:
        if math.prod(length / self.resolution for length in self.size) > MOST_CELLS:
            scan = "a height scan of {:g} x {:g} m at {:g} m".format(*self.size, self.resolution)
            mend = "give a smaller size or a coarser resolution"
            raise ValueError(f"{scan} has more than {MOST_CELLS} cells; {mend}")
        return self


class HeightScanSensor(OptionalSensor[HeightScanOptions]):
    """The height scan; the grid is level whichever way the rover leans."""

    sees_ground = True

    def _begin(self, installation: Installation[HeightScanOptions]) -> None:
        from harness.physics.world_geoms import OBSTACLE_GROUP  # noqa: PLC0415 - loads MuJoCo

        options = installation.options
        self._turns = options.axes == ROVER
        middles = ((np.arange(n) - 0.5 * (n - 1)) * options.resolution for n in options.cells)
        self._along, self._across = np.meshgrid(*middles, indexing="ij")
        self._reach = float(np.hypot(self._along, self._across).max())
        self._model = self._simulation.model
        if others := self._simulation.scene.others():  # met as obstacles are, even if transparent
            self._model = copy(self._model)
            self._model.geom_group[others], self._model.geom_matid[others] = OBSTACLE_GROUP, -1
            self._model.geom_rgba[others, 3] = 1.0
        self._obstacles = np.flatnonzero(self._model.geom_group == OBSTACLE_GROUP)
        self._group = (np.arange(6) == OBSTACLE_GROUP).astype(np.uint8)

    def read(self) -> HeightScan:
        """Returns the heights around where the rover is now."""
        simulation, pose = self._simulation, self.pose()
        x, y, z = pose[0].tolist()
        yaw = math.atan2(pose[2, 0], pose[1, 0]) if self._turns else 0.0
        cos, sin = math.cos(yaw), math.sin(yaw)
        east = x + cos * self._along - sin * self._across
        north = y + sin * self._along + cos * self._across
        ground = simulation.ground
        heights = np.maximum(ground.heights_at(east, north), self._obstacles_at(east, north, (x, y)))
        x_min, x_max, y_min, y_max = ground.bounds()
        heights[(east < x_min) | (east > x_max) | (north < y_min) | (north > y_max)] = np.nan
        return HeightScan(simulation.time_ns, self.name, (heights - z).astype(np.float32), x, y, z, yaw)

    def _obstacles_at(
        self, east: NDArray[np.float64], north: NDArray[np.float64], middle: tuple[float, float]
    ) -> NDArray[np.float64]:
        """The height of the highest obstacle over each point [m]; -inf where there is none."""
        import mujoco  # noqa: PLC0415 - see the module

        tops = np.full(east.shape, -np.inf)
        model, data = self._model, self._simulation.data
        centres, radii = data.geom_xpos[self._obstacles], model.geom_rbound[self._obstacles]
        near = np.hypot(*(centres[:, :2] - middle).T) <= radii + self._reach
        if not near.any():
            return tops
        centres, radii = centres[near], radii[near]
        offsets = np.hypot(east[..., None] - centres[:, 0], north[..., None] - centres[:, 1])
        start = float((centres[:, 2] + radii).max()) + ABOVE
        hit = np.zeros(1, np.int32)
        for cell in np.argwhere((offsets <= radii).any(axis=-1)):
            at = tuple(cell)
            point = np.array([east[at], north[at], start])
            distance = mujoco.mj_ray(model, data, point, DOWN, self._group, 1, -1, hit)
            if distance >= 0.0:
                tops[at] = start - distance
        return tops
