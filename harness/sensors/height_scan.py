"""A height scan: the ground and the obstacles around the rover as a grid of heights, without errors.

What a learner sees of the terrain, and what an elevation map of perfect sensors would hold. Heights are
those of what is met first from above; moving obstacles are where they are now.
"""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from harness.robots import FrameRow, RoverSpec
from harness.samples import plain_value
from harness.sensors.optional import Installation, OptionalSensor, Rate, SensorOptions
from harness.spec.value import Length

if TYPE_CHECKING:  # the table of sensors does without MuJoCo
    import mujoco

    from harness.physics.simulation import Simulation

ROVER: Final = "rover"  # ahead and left of the rover
WORLD: Final = "world"  # x and y of the world
ABOVE = 1.0  # [m] over the highest obstacle, from where is looked down
MOST_CELLS = 250_000
DOWN = np.array([0.0, 0.0, -1.0])


@plain_value
class HeightScan:
    """Heights around the rover.

    Attributes:
        heights: Heights of the cells' middles over the origin of the sensor's frame [m], float32,
            shape (cells along the first axis, along the second), each from the lowest coordinate
            up; NaN off the map.
        x: x of the grid's middle, which is that origin, in the world [m].
        y: y of the grid's middle [m].
        z: z of the grid's middle [m].
        yaw: Angle from the world's x axis to the grid's first one [rad].
    """

    stamp_ns: int
    sensor: str
    heights: NDArray[np.float32]
    x: float
    y: float
    z: float
    yaw: float


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
    def cells(self) -> tuple[int, int]:
        """Returns the number of cells along each axis."""
        along, across = (max(1, round(length / self.resolution)) for length in self.size)
        return along, across

    @model_validator(mode="after")
    def _check_cells(self) -> Self:
        if math.prod(length / self.resolution for length in self.size) > MOST_CELLS:
            raise ValueError(
                f"a height scan of {self.size[0]:g} x {self.size[1]:g} m at {self.resolution:g} m has "
                f"more than {MOST_CELLS} cells; give a smaller size or a coarser resolution"
            )
        return self


class HeightScanSensor(OptionalSensor[HeightScanOptions]):
    """The height scan; the grid is level whichever way the rover leans."""

    def __init__(
        self,
        simulation: "Simulation",
        installation: Installation[HeightScanOptions],
        period_ticks: int,
    ) -> None:
        super().__init__(simulation, installation, period_ticks)
        from harness.physics.scene import OBSTACLE_GROUP  # noqa: PLC0415 - loads MuJoCo

        options = installation.options
        self._turns = options.axes == ROVER
        middles = ((np.arange(n) - 0.5 * (n - 1)) * options.resolution for n in options.cells)
        self._along, self._across = np.meshgrid(*middles, indexing="ij")
        self._reach = float(np.hypot(self._along, self._across).max())
        self._others = simulation.scene.others()
        self._obstacles = np.append(
            np.flatnonzero(simulation.model.geom_group == OBSTACLE_GROUP), self._others
        ).astype(int)
        self._group = np.zeros(6, np.uint8)
        self._group[OBSTACLE_GROUP] = 1

    def read(self) -> HeightScan:
        """Returns the heights around where the rover is now."""
        simulation, ((x, y, z), axes) = self._simulation, self.pose()
        yaw = math.atan2(axes[1, 0], axes[0, 0]) if self._turns else 0.0
        cos, sin = math.cos(yaw), math.sin(yaw)
        east = x + cos * self._along - sin * self._across
        north = y + sin * self._along + cos * self._across
        ground = simulation.scene.world.ground
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
        model, data = self._simulation.model, self._simulation.data
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
            below = [distance, *(_down_to(geom, model, data, point) for geom in self._others)]
            hits = [distance for distance in below if distance >= 0.0]
            if hits:
                tops[at] = start - min(hits)
        return tops


def _down_to(
    geom: int, model: "mujoco.MjModel", data: "mujoco.MjData", point: NDArray[np.float64]
) -> float:
    """How far below a point a part of another rover begins [m]; negative if it does not."""
    import mujoco  # noqa: PLC0415 - see the module

    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
        return float(mujoco.mj_rayMesh(model, data, geom, point, DOWN))
    place = data.geom_xpos[geom], data.geom_xmat[geom], model.geom_size[geom]
    return float(mujoco.mju_rayGeom(*place, point, DOWN, model.geom_type[geom]))
