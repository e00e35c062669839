"""What optional sensors of position, field, air and terrain must say: rows of the oracle.

Sources: WGS-84 and the ICAO atmosphere by their definitions, the first degree of WMM2025, MuJoCo's rays.
"""

import math
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from tests.e2e.topic_oracle.twin import Twin, Values

DATUM = (38.4064, -110.7919, 1382.0)  # of Utah's Mars Desert Research Station
RESOLUTION, CELLS = 0.2, (6, 4)  # [m], along x and y
# All sit on the base; the compass is turned.
MOUNT, RPY = [0.1, -0.05, 0.3], [0.1, 0.2, -0.3]
BASE = {"leo": "base_footprint", "rover_zero4wd": "base_link"}
SENSORS: tuple[Mapping[str, Any], ...] = (
    {"kind": "gnss"},
    {"kind": "magnetometer", "topic": "imu/mag"},
    {"kind": "barometer"},
    {"kind": "height_scan", "grid_map": True, "axes": "world", "resolution": RESOLUTION}
    | {"size": [n * RESOLUTION for n in CELLS]},
)


def carried(robot: str) -> tuple[Mapping[str, Any], ...]:
    """`sensors:` of a rover's rover.yaml."""
    return tuple(some | {"parent": BASE[robot], "xyz": MOUNT, "rpy": RPY} for some in SENSORS)


def place(twin: Twin) -> Values:
    """Where they are in the world [m]; the base of rover_zero4wd is 2 mm above the ground, its model's too."""
    data, base = twin.data, {"leo": 0.0, "rover_zero4wd": -0.125}[twin.rover.name]
    return np.asarray(data.qpos[:3] + twin.attitude.apply(np.add(MOUNT, (0.0, 0.0, base))))
