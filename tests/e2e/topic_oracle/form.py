"""The shapes of what messages have in common, as expectations, and MuJoCo's own rays."""

import math
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from tests.e2e.topic_oracle.twin import Twin, Values

Expected = Mapping[str, Any]


def stamp(time_ns: int) -> Expected:
    """builtin_interfaces/Time."""
    return {"sec": time_ns // 10**9, "nanosec": time_ns % 10**9}


def header(twin: Twin, frame: str) -> Expected:
    """std_msgs/Header."""
    return {"stamp": stamp(twin.time_ns), "frame_id": frame}


def vector(values: Any) -> Expected:  # noqa: ANN401 - three numbers
    """geometry_msgs/Vector3 or Point."""
    return dict(zip("xyz", values, strict=True))


def ray(twin: Twin, data: mujoco.MjData, origin: Values, ahead: Values) -> tuple[float, int]:
    """How far it is along a unit vector of the world to terrain or obstacle, and which geom that is."""
    seen, hit = np.array([1, 1, 0, 0, 0, 0], np.uint8), np.zeros(1, np.int32)  # not the rover
    distance = mujoco.mj_ray(twin.model, data, origin, ahead, seen, 1, -1, hit)
    return (distance if distance >= 0.0 else math.inf), int(hit[0])


def in_limits(distance: float, nearest: float, farthest: float) -> float:
    """REP-117: infinite beyond the limits, negative where it is too near."""
    return math.inf if distance > farthest else -math.inf if distance < nearest else distance


def laser_scan(
    frame: Expected,
    angles: Values,
    limits: tuple[float, float],
    ranges: list[float] | Values,
    intensities: int,
) -> Expected:
    """sensor_msgs/LaserScan, whose geometry is of float32."""
    names = ("angle_min", "angle_max", "angle_increment", "range_min", "range_max")
    values = (angles[0], angles[-1], angles[1] - angles[0], *limits)
    return {
        "header": frame,
        **{name: float(np.float32(value)) for name, value in zip(names, values, strict=True)},
        "time_increment": 0.0,
        "scan_time": 0.0,
        "ranges": np.array(ranges),
        "intensities": np.zeros(intensities),
    }
