"""Maps that were heard, cell by cell against the world graded for the rover."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.base.message_types import GRID_MAP
from harness.base.sim_time import NANOSECONDS
from harness.scenario.names import HeardQuantity
from harness.scenario.series import Series
from harness.world.grading import Cells, GradedMap
from harness.world.heightfield import EDGE_MARGIN
from rover_metrics.core import rotation
from rover_metrics.topics import quaternion, stamp_ns

TYPES = ("nav_msgs/msg/OccupancyGrid", GRID_MAP)
FREE, OCCUPIED = 0.25, 0.65  # map_server's thresholds of a map that is drawn
# Layers of a GridMap that say what a cell costs, from 0 to 1, and those that say the contrary.
COSTS, MERITS = ("danger", "cost", "risk", "occupancy"), ("traversability",)


@dataclass(frozen=True, eq=False)
class Grid:
    """A map that was heard.

    Attributes:
        stamp_ns: Of its header.
        costs: 0 free to 1 occupied, NaN unknown; rows with its y, columns with its x.
        resolution: Side length of a cell [m].
        origin: x, y [m] and yaw [rad] of the first cell's outer corner in the world.
    """

    stamp_ns: int
    costs: NDArray[np.float32]
    resolution: float
    origin: tuple[float, float, float]

    def places(self) -> tuple[Cells, Cells]:
        """Returns x and y of the cells' middles in the world [m]."""
        rows, columns = self.costs.shape
        u, v = np.meshgrid(*((np.arange(count) + 0.5) * self.resolution for count in (columns, rows)))
        x, y, yaw = self.origin
        cos, sin = np.cos(yaw), np.sin(yaw)
        return x + cos * u - sin * v, y + sin * u + cos * v


def grids_of(message: Any) -> Iterable[Grid]:  # noqa: ANN401 - of rclpy or of rosbags
    """Returns the map of a message of TYPES; ValueError if it has none that says what cells cost."""
    return (_grid_map(message) if hasattr(message, "layers") else _occupancy_grid(message),)


def _occupancy_grid(message: Any) -> Grid:  # noqa: ANN401
    info = message.info
    values = np.array(message.data, dtype=np.int8).astype(np.float32).reshape(info.height, info.width)
    values[values < 0] = np.nan
    at = info.origin.position
    origin = (at.x, at.y, rotation.yaw(quaternion(info.origin.orientation)))
    return Grid(stamp_ns(message), values / 100.0, float(info.resolution), origin)


def _grid_map(message: Any) -> Grid:  # noqa: ANN401
    """Rows of a GridMap count against x, columns against y, and it stores column after column."""
    info, layers = message.info, list(message.layers)
    name = next((name for name in (*COSTS, *MERITS) if name in layers), None)
    if name is None:
        known = ", ".join((*COSTS, *MERITS))
        raise ValueError(f"none of its layers says what a cell costs; known are {known}")
    array = message.data[layers.index(name)]
    columns, rows = (dimension.size for dimension in array.layout.dim)
    values = np.array(array.data, dtype=np.float32).reshape(columns, rows).T
    values = np.roll(values, (-message.outer_start_index, -message.inner_start_index), (0, 1))
    costs = values[::-1, ::-1].T  # rows with y, columns with x
    yaw, at = rotation.yaw(quaternion(info.pose.orientation)), info.pose.position
    half = 0.5 * np.array([info.length_x, info.length_y])
    cos, sin = np.cos(yaw), np.sin(yaw)
    x, y = at.x - cos * half[0] + sin * half[1], at.y - sin * half[0] - cos * half[1]
    cost = 1.0 - costs if name in MERITS else costs
    return Grid(stamp_ns(message), cost, float(info.resolution), (float(x), float(y), yaw))


def map_series(quantity: HeardQuantity, grids: Sequence[Grid], truth: GradedMap) -> Series:
    """Returns a quantity of each map that was heard; NaN where no cell counts.

    Args:
        quantity: Its measure is one of OF_MAPS.
        grids: The maps, by time.
        truth: The world graded for the rover.
    """
    times = np.array([grid.stamp_ns for grid in grids]) / NANOSECONDS
    values = np.array([share(quantity.measure, grid, truth) for grid in grids], dtype=float)
    return Series(times, values, nothing=f"no map was heard on {quantity.topic} that could be judged")


def share(measure: str, grid: Grid, truth: GradedMap) -> float:
    """Returns a share of a map's cells, 0 to 1; NaN where none counts.

    Args:
        measure: One of OF_MAPS.
        grid: The map.
        truth: The world graded for the rover.
    """
    x, y = grid.places()
    inset = truth.resolution * np.array(truth.layers["danger"].shape)[::-1] - EDGE_MARGIN
    low = np.array(truth.corner) + EDGE_MARGIN
    high = np.array(truth.corner) + inset
    danger = truth.danger_at(x, y)
    inside = (x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1]) & np.isfinite(danger)
    known = inside & np.isfinite(grid.costs)
    if measure == "coverage":
        return _share(known, inside)
    if measure == "false_safe":
        counts = known & (danger >= 1.0)
        return _share(counts & (grid.costs <= FREE), counts)
    counts = known & (danger < 1.0)
    return _share(counts & (grid.costs >= OCCUPIED), counts)


def _share(some: NDArray[np.bool_], of: NDArray[np.bool_]) -> float:
    count = int(of.sum())
    return int(some.sum()) / count if count else float("nan")
