"""A height scan: the ground and the obstacles around the rover as a grid of heights, without errors.

What a learner sees of the terrain, and what an elevation map of perfect sensors would hold. Heights are
those of what is met first from above; moving obstacles are where they are now.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError, find_named
from harness.samples import plain_value
from harness.sensors.base import Sensor

if TYPE_CHECKING:  # the table of sensors does without MuJoCo
    from harness.physics.simulation import Simulation

ROVER, WORLD = "rover", "world"
AXES = {ROVER: "ahead and left of the rover", WORLD: "x and y of the world"}
ABOVE = 1.0  # [m] over the highest obstacle, from where is looked down
MOST_CELLS = 250_000
DOWN = np.array([0.0, 0.0, -1.0])


@plain_value
class HeightScan:
    """Heights around the rover.

    Attributes:
        heights: Of the cells' middles over the origin of the model frame [m], float32, shape (cells along
            the first axis, along the second), each from the lowest coordinate up; NaN off the map.
        x: The grid's middle, which is the origin of the model frame [m]; likewise `y`, `z`.
        yaw: Angle from the world's x axis to the grid's first one [rad].
    """

    stamp_ns: int
    heights: NDArray[np.float32]
    x: float
    y: float
    z: float
    yaw: float


@dataclass(frozen=True, kw_only=True)
class HeightScanOptions:
    """Of a height scan.

    Attributes:
        size: Lengths along the grid's first and second axis [m]; at least a cell each.
        resolution: Side length of a cell [m].
        axes: One of AXES: whether the grid turns with the rover's heading.
    """

    size: tuple[float, float] = (2.0, 2.0)
    resolution: float = 0.1
    axes: str = ROVER

    @property
    def cells(self) -> tuple[int, int]:
        """Returns the number of cells along each axis."""
        along, across = (max(1, round(length / self.resolution)) for length in self.size)
        return along, across

    def check(self) -> None:
        """Checks the values.

        Raises:
            UsageError: One is not valid; the message names those that are.
        """
        find_named("axes", self.axes, AXES)
        for name, value in (("resolution", self.resolution), *(("size", s) for s in self.size)):
            if not (math.isfinite(value) and value > 0.0):
                raise UsageError(f"{name} {value:g} m is not valid; give a number above 0")
        if math.prod(length / self.resolution for length in self.size) > MOST_CELLS:
            raise UsageError(
                f"a height scan of {self.size[0]:g} x {self.size[1]:g} m at {self.resolution:g} m has more "
                f"than {MOST_CELLS} cells; give a smaller size or a coarser resolution"
            )


class HeightScanSensor(Sensor):
    """The height scan."""

    def __init__(
        self, simulation: "Simulation", options: HeightScanOptions, period_ticks: int
    ) -> None:
        super().__init__(simulation, period_ticks)
        from harness.physics.scene import OBSTACLE_GROUP  # noqa: PLC0415 - loads MuJoCo

        self._turns = options.axes == ROVER
        middles = ((np.arange(n) - 0.5 * (n - 1)) * options.resolution for n in options.cells)
        self._along, self._across = np.meshgrid(*middles, indexing="ij")
        self._reach = float(np.hypot(self._along, self._across).max())
        self._obstacles = np.flatnonzero(simulation.model.geom_group == OBSTACLE_GROUP)
        self._group = np.zeros(6, np.uint8)
        self._group[OBSTACLE_GROUP] = 1

    def read(self) -> HeightScan:
        """Returns the heights around where the rover is now."""
        simulation = self._simulation
        (x, y, z), yaw = simulation.position, simulation.yaw if self._turns else 0.0
        cos, sin = math.cos(yaw), math.sin(yaw)
        east = x + cos * self._along - sin * self._across
        north = y + sin * self._along + cos * self._across
        ground = simulation.scene.world.ground
        heights = np.maximum(ground.heights_at(east, north), self._obstacles_at(east, north, (x, y)))
        half_x, half_y = ground.half_size
        heights[(np.abs(east) > half_x) | (np.abs(north) > half_y)] = np.nan
        return HeightScan(simulation.time_ns, (heights - z).astype(np.float32), x, y, z, yaw)

    def _obstacles_at(
        self, east: NDArray[np.float64], north: NDArray[np.float64], middle: tuple[float, float]
    ) -> NDArray[np.float64]:
        """The height of the highest obstacle over each point [m]; -inf where there is none."""
        import mujoco  # noqa: PLC0415 - see the module

        tops = np.full(east.shape, -np.inf)
        model, data = self._simulation.model, self._simulation.data
        mujoco.mj_kinematics(model, data)  # poses are one step old
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
