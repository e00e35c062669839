"""What optional sensors of position, field, air and terrain must say: rows of the oracle.

Sources: the ICAO atmosphere by its definition, MuJoCo's rays; test_geodesy.py holds a datum's positions
and its field to WGS-84 and the first degree of WMM2025.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from harness.world.geodesy import Datum
from tests.e2e.topic_oracle import ranging
from tests.e2e.topic_oracle.form import header, ray, vector
from tests.e2e.topic_oracle.ranging import MOUNT, RPY
from tests.e2e.topic_oracle.twin import Twin, Values

DATUM = (38.4064, -110.7919, 1382.0)  # of Utah's Mars Desert Research Station
RESOLUTION, CELLS = 0.2, (6, 4)  # [m], along x and y
BASE = {"leo": "base_footprint", "rover_zero4wd": "base_link"}
SENSORS: tuple[Mapping[str, Any], ...] = (
    *ranging.SENSORS,
    {"kind": "gnss"},
    {"kind": "magnetometer", "topic": "imu/mag"},
    {"kind": "barometer"},
    {"kind": "height_scan", "grid_map": True, "axes": "world", "resolution": RESOLUTION}
    | {"size": [n * RESOLUTION for n in CELLS]},
)


def carried(robot: str) -> tuple[Mapping[str, Any], ...]:
    """`sensors:` of a rover's rover.yaml."""
    return tuple({**some, "parent": BASE[robot], "xyz": MOUNT, "rpy": RPY} for some in SENSORS)


def frames(robot: str) -> list[tuple[Any, ...]]:
    """Parent, child, x y z and roll pitch yaw of each; the depth camera has an optical frame too."""
    told: list[tuple[Any, ...]] = []
    for some in SENSORS:
        frame = f"{some['kind']}_link"
        told.append((BASE[robot], frame, tuple(MOUNT), tuple(RPY)))
        if some["kind"] == "depth":
            optical = (-math.pi / 2, 0.0, -math.pi / 2)
            told.append((frame, f"{some['kind']}_optical_frame", (0.0, 0.0, 0.0), optical))
    return told


def place(twin: Twin) -> Values:
    """Where they are in the world [m]."""
    return np.asarray(twin.data.qpos[:3] + twin.attitude.apply(MOUNT))


def fix(twin: Twin) -> Mapping[str, Any]:
    """sensor_msgs/NavSatFix, exact."""
    latitude, longitude, altitude = Datum(*DATUM).geodetic(tuple(place(twin)))
    return {
        "header": header(twin, "gnss_link"),
        "status": {"status": 0, "service": 15},
        "latitude": latitude,
        "longitude": longitude,
        "altitude": altitude,
        "position_covariance": np.zeros(9),
        "position_covariance_type": 0,
    }


def magnetic_field(twin: Twin) -> Mapping[str, Any]:
    """sensor_msgs/MagneticField: the datum's, in the axes of the sensor."""
    in_sensor = twin.attitude * Rotation.from_euler("xyz", RPY)
    return {
        "header": header(twin, "magnetometer_link"),
        "magnetic_field": vector(in_sensor.inv().apply(Datum(*DATUM).magnetic_field(2026.0))),
        "magnetic_field_covariance": np.zeros(9),
    }


def pressure(twin: Twin) -> Mapping[str, Any]:
    """sensor_msgs/FluidPressure: the ICAO atmosphere's 101325 Pa (1 - 2.25577e-5 h)^5.25588."""
    height = DATUM[2] + float(place(twin)[2])
    exact = 101_325.0 * (1 - 0.0065 * height / 288.15) ** (9.80665 / (287.05287 * 0.0065))
    return {"header": header(twin, "barometer_link"), "fluid_pressure": exact, "variance": 0.0}


def grid_map(twin: Twin) -> Mapping[str, Any]:
    """grid_map_msgs/GridMap: rows against x, columns against y, column by column; rays from above."""
    data, (x, y, _), (rows, columns) = twin.at_present(), place(twin), CELLS
    half_x, half_y = twin.world.ground.half_size
    heights = []
    for column in range(columns):
        for row in range(rows):
            east = x + (0.5 * (rows - 1) - row) * RESOLUTION
            north = y + (0.5 * (columns - 1) - column) * RESOLUTION
            above, down = np.array([east, north, 9.0]), np.array([0.0, 0.0, -1.0])
            distance, _ = ray(twin, data, above, down)
            on_map = abs(east) <= half_x and abs(north) <= half_y
            heights.append(9.0 - distance if on_map else math.nan)
    dimensions = [
        {"label": "column_index", "size": columns, "stride": rows * columns},
        {"label": "row_index", "size": rows, "stride": rows},
    ]
    pose = {
        "position": vector((float(x), float(y), 0.0)),
        "orientation": {**vector((0.0, 0.0, 0.0)), "w": 1.0},
    }
    info = {"length_x": rows * RESOLUTION, "length_y": columns * RESOLUTION, "resolution": RESOLUTION}
    return {
        "header": header(twin, "odom"),
        "info": info | {"pose": pose},
        "layers": ["elevation"],
        "basic_layers": ["elevation"],
        "data": [{"layout": {"dim": dimensions, "data_offset": 0}, "data": np.array(heights)}],
        "outer_start_index": 0,
        "inner_start_index": 0,
    }
