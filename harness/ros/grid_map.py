"""Height scans as grid_map_msgs/GridMap, whose type no wheel ships: as the bytes that rosbags writes.

A GridMap counts its rows against x and its columns against y, and stores column after column.
"""

from typing import Any

import numpy as np

from harness.base.sim_time import NANOSECONDS
from harness.frames.tree import ODOM
from harness.ros.channel import Fill
from harness.sensors.height_scan import HeightScan, HeightScanOptions
from harness.sensors.message_types import GRID_MAP, typestore

LAYER = "elevation"


def grid_map_fill(options: HeightScanOptions) -> Fill:
    """Returns a filler of maps of absolute heights, in odom, which is the world.

    With axes `rover` the pose of the map is turned with the rover, which readers that know only its
    position leave out; with axes `world` it is not.
    """
    rows, columns = options.cells
    dimensions = [
        _made("std_msgs/msg/MultiArrayDimension", "column_index", columns, rows * columns),
        _made("std_msgs/msg/MultiArrayDimension", "row_index", rows, rows),
    ]
    layout = _made("std_msgs/msg/MultiArrayLayout", dimensions, 0)
    lengths = rows * options.resolution, columns * options.resolution

    def fill(scan: HeightScan) -> bytes:
        stamp = _made("builtin_interfaces/msg/Time", *divmod(scan.stamp_ns, NANOSECONDS))
        turned = (0.0, 0.0, float(np.sin(scan.yaw / 2)), float(np.cos(scan.yaw / 2)))
        pose = _made(
            "geometry_msgs/msg/Pose",
            _made("geometry_msgs/msg/Point", scan.x, scan.y, 0.0),
            _made("geometry_msgs/msg/Quaternion", *turned),
        )
        heights = np.asarray(scan.heights[::-1, ::-1].ravel(order="F") + np.float32(scan.z), np.float32)
        message = _made(
            GRID_MAP,
            _made("std_msgs/msg/Header", stamp, ODOM),
            _made("grid_map_msgs/msg/GridMapInfo", options.resolution, *lengths, pose),
            [LAYER],
            [LAYER],
            [_made("std_msgs/msg/Float32MultiArray", layout, heights)],
            0,
            0,
        )
        return bytes(typestore().serialize_cdr(message, GRID_MAP))

    return fill


def _made(name: str, *values: Any) -> Any:  # noqa: ANN401 - rosbags makes its classes
    return typestore().types[name](*values)
