"""Paths into messages: what they lead to, and what is wrong with those that lead nowhere."""

from typing import Any

import numpy as np
import pytest

from harness.base.message_types import check_path, numbers_at, typestore

ODOMETRY, SCAN = "nav_msgs/msg/Odometry", "sensor_msgs/msg/LaserScan"
POSES, GRID = "geometry_msgs/msg/PoseArray", "grid_map_msgs/msg/GridMap"


@pytest.mark.parametrize(
    ("kind", "path", "told"),
    [
        (ODOMETRY, "twist.twist.linear.x", None),
        (SCAN, "ranges[0]", None),
        (POSES, "poses.position.x", None),
        (POSES, "poses[2].position.x", None),
        ("my_msgs/msg/Mine", "anything[3].goes", None),
        *((GRID, path, None) for path in ("info.length_x", "data[0].data[3]", "outer_start_index")),
        (GRID, "basic_layers[0]", "it leads to text"),
        (ODOMETRY, "twst", "field 'twst' does not exist; did you mean 'twist'? (nav_msgs/msg/Odometry)"),
        (SCAN, "x", "field 'x' does not exist; available: header, angle_min, "),
        (ODOMETRY, "twist.twist", "it leads to a geometry_msgs/msg/Twist; go on with one of: linear, a"),
        (POSES, "header.frame_id", "it leads to text; give a field with numbers"),
        (SCAN, "ranges.x", "there is nothing below the numbers in front of '.x' in 'ranges.x'"),
        (SCAN, "range_min[2]", "field 'range_min' is no list; leave out [2] (sensor_msgs/msg/Laser"),
        ("my_msgs/msg/Mine", "a..b", "'a..b' is no path to a field; give e.g. twist.linear.x"),
    ],
)
def test_a_path_leads_to_numbers_or_is_told(kind: str, path: str, told: str | None) -> None:
    found = check_path(kind, path)
    assert found is None if told is None else str(found).startswith(told)


def poses(*xs: float) -> Any:  # noqa: ANN401 - of rosbags
    types = typestore().types

    def made(name: str, *values: Any) -> Any:  # noqa: ANN401
        return types[name](*values)

    turn = made("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
    points = [made("geometry_msgs/msg/Point", x, 0.5, 0.0) for x in xs]
    return made(POSES, None, [made("geometry_msgs/msg/Pose", point, turn) for point in points])


def test_the_numbers_of_all_elements_or_of_one_come_as_numbers_whatever_holds_them() -> None:
    for path, numbers in (
        *(("poses.position.x", [3.0, -1.0, 2.0]), ("poses[1].position.x", [-1.0])),
        ("poses[3].position.x", []),
    ):
        assert numbers_at(poses(3.0, -1.0, 2.0), path) == numbers

    class Status:
        level, flag, data, text = b"\x02", True, np.array([1.5, np.inf], dtype=np.float32), "two"

    assert [numbers_at(Status, name) for name in ("level", "flag", "data", "data[1]")] == [
        *([2.0], [1.0], [1.5, np.inf], [np.inf])
    ]
    with pytest.raises(AttributeError):
        numbers_at(Status, "levl")
    with pytest.raises(ValueError, match="two"):
        numbers_at(Status, "text")
