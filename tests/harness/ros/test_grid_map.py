"""A height scan as a GridMap: read as grid_map_core reads it."""

from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.ros.foreign_type import message_type
from harness.ros.grid_map import grid_map_fill
from harness.sensors.height_scan import HeightScan, HeightScanOptions
from harness.sensors.message_types import GRID_MAP, typestore

OPTIONS = HeightScanOptions(name="scan", size=(0.6, 0.4), resolution=0.2)  # 3 x 2 cells


def test_every_cell_is_where_grid_map_looks_for_it() -> None:
    """grid_map: index (0, 0) is at the largest x and y; data column by column (column-major)."""
    heights = np.array([[0.0, 1.0], [2.0, 3.0], [np.nan, 5.0]], np.float32)  # from the lowest x and y
    scan = HeightScan(12_000_000_345, "scan", heights, x=10.0, y=20.0, z=0.5, yaw=np.pi / 2)
    told: Any = typestore().deserialize_cdr(grid_map_fill(OPTIONS)(scan), GRID_MAP)
    assert (told.header.stamp.sec, told.header.stamp.nanosec, told.header.frame_id) == (12, 345, "odom")
    info, (layer,) = told.info, told.data
    assert (info.resolution, info.length_x, info.length_y) == pytest.approx((0.2, 0.6, 0.4))
    place, turn = info.pose.position, info.pose.orientation
    assert (place.x, place.y, place.z) == (10.0, 20.0, 0.0)
    assert (turn.x, turn.y, turn.z, turn.w) == pytest.approx((0.0, 0.0, 0.5**0.5, 0.5**0.5))
    assert (told.layers, told.basic_layers) == (["elevation"], ["elevation"])
    assert (told.outer_start_index, told.inner_start_index, layer.layout.data_offset) == (0, 0, 0)
    assert [(d.label, d.size, d.stride) for d in layer.layout.dim] == [
        ("column_index", 2, 6),
        ("row_index", 3, 3),
    ]
    assert layer.data.dtype == np.float32
    for row, x in enumerate((2, 1, 0)):
        for column, y in enumerate((1, 0)):
            value = layer.data[column * 3 + row]
            np.testing.assert_equal(value, heights[x, y] + np.float32(0.5))


def test_its_type_is_that_of_grid_map_msgs() -> None:
    """The names and types of grid_map_msgs of ROS 2, as `ros2 interface show` prints them."""
    definition, _ = typestore().generate_msgdef(GRID_MAP, ros_version=2)
    info, _ = typestore().generate_msgdef("grid_map_msgs/msg/GridMapInfo", ros_version=2)
    first = definition.split("=" * 80)[0].split("\n")
    assert [line.split() for line in first if line] == [
        ["std_msgs/Header", "header"],
        ["grid_map_msgs/GridMapInfo", "info"],
        ["string[]", "layers"],
        ["string[]", "basic_layers"],
        ["std_msgs/Float32MultiArray[]", "data"],
        ["uint16", "outer_start_index"],
        ["uint16", "inner_start_index"],
    ]
    assert [line.split() for line in info.split("=" * 80)[0].split("\n") if line] == [
        ["float64", "resolution"],
        ["float64", "length_x"],
        ["float64", "length_y"],
        ["geometry_msgs/Pose", "pose"],
    ]
    made = message_type(GRID_MAP)
    assert made is not None
    assert made.__name__ == "GridMap"
