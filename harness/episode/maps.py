"""The world's truth for one rover as bytes: /map, and /map/truth where it is asked for."""

import numpy as np

from harness.base.message_types import GRID_MAP
from harness.messages.blank import blank, cdr
from harness.messages.optional import grid_map
from harness.messages.refilled import set_stamp
from harness.sensors.table import Topic
from harness.world.grading import GradedMap
from harness.world.occupancy import OccupancyMap

GRADED = Topic("map/truth", GRID_MAP, depth=1, latched=True)
MAP = Topic("map", "nav_msgs/msg/OccupancyGrid", depth=1, latched=True)


def occupancy_bytes(grid: OccupancyMap, time_ns: int) -> bytes:
    """Returns an OccupancyGrid of a map, made at a simulation time."""
    message = blank(MAP.message_type)
    message.header.frame_id = "map"
    for stamp in (message.header.stamp, message.info.map_load_time):
        set_stamp(stamp, time_ns)
    message.info.resolution = float(grid.resolution)
    message.info.height, message.info.width = grid.cells.shape
    corner = message.info.origin.position
    corner.x, corner.y = (float(at - half) for at, half in zip(grid.middle, grid.half_size, strict=True))
    message.data = grid.cells.ravel().view(np.int8)
    return cdr(message)


def graded_bytes(graded: GradedMap, time_ns: int) -> bytes:
    """Returns a GridMap of the graded world; `traversability` is 1 where no limit is near, 0 at one."""
    layers = graded.layers | {"traversability": np.clip(1.0 - graded.layers["danger"], 0.0, 1.0)}
    rows, columns = layers["danger"].shape
    half = 0.5 * graded.resolution
    middle = (graded.corner[0] + half * columns, graded.corner[1] + half * rows, 0.0)
    turned = {name: layer.T.astype(np.float32) for name, layer in layers.items()}
    return grid_map(time_ns, "map", graded.resolution, middle, turned)
