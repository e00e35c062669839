"""What optional lidars and depth cameras must say, ray by ray with MuJoCo's own: rows of the oracle.

Sources: REP-117 (ranges), REP-118 (depth images), REP-103 (optical frames), the layout of the clouds of
velodyne_pointcloud and depth_image_proc, the pinhole camera.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from tests.e2e.topic_oracle.form import header
from tests.e2e.topic_oracle.twin import Twin, Values

MOUNT, RPY = [0.1, -0.05, 0.3], [0.1, 0.2, -0.3]
NEAR, FAR = 0.3, 1.2  # [m]: on the stage some rays meet something nearer, some nothing
PLANAR = {"beams": 9, "angle_min": -2.4, "angle_max": 1.6}
RINGS, COLUMNS, LOWEST, HIGHEST = 3, 6, -0.6, 0.4
WIDTH, HEIGHT, FOV = 5, 4, 1.3
LIMITS = {"range_min": NEAR, "range_max": FAR}
SENSORS: tuple[Mapping[str, Any], ...] = (
    {"kind": "lidar2d", "rate": 5, **PLANAR, **LIMITS},
    {"kind": "lidar3d", "rate": 5, "rings": RINGS, "columns": COLUMNS, "lowest": LOWEST}
    | {"highest": HIGHEST, **LIMITS},
    {"kind": "depth", "rate": 5, "width": WIDTH, "height": HEIGHT, "fov": FOV, "cloud": True, **LIMITS},
)
OPTICAL = Rotation.from_matrix([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])  # z ahead, x right, y down
FLOAT32, UINT16 = 7, 4  # of sensor_msgs/PointField
CLOSE = 2e-6  # [m]: float32 of at most 2 m, from two ways to compute it
EARTH, THING = 25.0, 50.0  # reflectivities [%] that stand in docs/sensors.md


@dataclass(frozen=True)
class Records:
    """The bytes of an array of numbers, or of points of several fields, to float32's precision."""

    values: Values  # shape (n, fields)
    layout: np.dtype[Any]

    def __eq__(self, told: object) -> bool:
        records = np.frombuffer(bytes(told), self.layout)  # type: ignore[call-overload]
        names = self.layout.names
        columns = [records[name] for name in names] if names else [records]
        found = np.column_stack([column.astype(float) for column in columns])
        return found.shape == self.values.shape and np.allclose(
            found, self.values, 0.0, CLOSE, equal_nan=True
        )

    __hash__ = None  # type: ignore[assignment]  # nobody asks


def ray(twin: Twin, data: mujoco.MjData, turn: Rotation, direction: Values) -> tuple[float, bool]:
    """How often a vector of the sensor's frame fits up to what it meets; whether that is an obstacle."""
    seen, hit = np.array([1, 1, 0, 0, 0, 0], np.uint8), np.zeros(1, np.int32)
    origin = twin.data.qpos[:3] + twin.attitude.apply(MOUNT)
    length = float(np.linalg.norm(direction))
    ahead = turn.apply(direction / length)
    distance = mujoco.mj_ray(twin.model, data, origin, ahead, seen, 1, -1, hit)
    if distance < 0.0 or distance / length > FAR:
        return math.inf, False
    thing = twin.model.geom(int(hit[0])).type[0] != mujoco.mjtGeom.mjGEOM_HFIELD
    return (distance / length if distance / length >= NEAR else -math.inf), bool(thing)


def cast(twin: Twin, directions: Values, turn: Rotation) -> tuple[Values, Values]:
    """Ranges and intensities along vectors."""
    data = twin.at_present()
    met = [ray(twin, data, twin.attitude * turn, direction) for direction in directions]
    return np.array([r for r, _ in met]), np.array([THING if is_thing else EARTH for _, is_thing in met])


def spherical(azimuth: float, elevation: float) -> Values:
    """A unit vector."""
    level = math.cos(elevation)
    return np.array([level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)])


def planar_scan(twin: Twin) -> Mapping[str, Any]:
    """sensor_msgs/LaserScan."""
    first, last, beams = PLANAR["angle_min"], PLANAR["angle_max"], int(PLANAR["beams"])
    step = (last - first) / (beams - 1)
    directions = np.array([spherical(first + beam * step, 0.0) for beam in range(beams)])
    told = {"angle_min": first, "angle_max": last, "angle_increment": step} | LIMITS
    return {
        "header": header(twin, "lidar2d_link"),
        **{name: float(np.float32(value)) for name, value in told.items()},
        "time_increment": 0.0,
        "scan_time": 0.0,
        "ranges": cast(twin, directions, Rotation.from_euler("xyz", RPY))[0],
        "intensities": np.zeros(0),
    }


def cloud(
    frame: Mapping[str, Any], layout: np.dtype[Any], points: Values, shape: tuple[int, int]
) -> Any:  # noqa: ANN401
    """sensor_msgs/PointCloud2."""
    kinds = {"f": FLOAT32, "u": UINT16}
    fields: Mapping[str, Any] = layout.fields or {}
    return {
        "header": frame,
        "height": shape[0],
        "width": shape[1],
        "fields": [
            {"name": name, "offset": offset, "datatype": kinds[kind.kind], "count": 1}
            for name, (kind, offset, *_) in fields.items()
        ],
        "is_bigendian": False,
        "point_step": layout.itemsize,
        "row_step": layout.itemsize * shape[1],
        "data": Records(points, layout),
        "is_dense": bool(np.isfinite(points).all()),
    }


def lidar_points(twin: Twin) -> Mapping[str, Any]:
    """The highest ring first, each from -pi around; what meets nothing, or is too near, is left out."""
    elevations = [LOWEST + (HIGHEST - LOWEST) * ring / (RINGS - 1) for ring in range(RINGS)]
    azimuths = [-math.pi + math.tau * column / COLUMNS for column in range(COLUMNS)]
    rings = [ring for ring in reversed(range(RINGS)) for _ in azimuths]
    directions = np.array([spherical(a, e) for e in reversed(elevations) for a in azimuths])
    ranges, intensities = cast(twin, directions, Rotation.from_euler("xyz", RPY))
    with np.errstate(invalid="ignore"):
        at = directions * ranges[:, None]
    points = np.column_stack([at, intensities, rings, np.zeros(len(rings))])[np.isfinite(ranges)]
    names = [
        ("x", "<f4"),
        ("y", "<f4"),
        ("z", "<f4"),
        ("intensity", "<f4"),
        ("ring", "<u2"),
        ("time", "<f4"),
    ]
    return cloud(header(twin, "lidar3d_link"), np.dtype(names), points, (1, len(points)))  # type: ignore[no-any-return]


def pixels() -> Values:
    """What each pixel looks at, of depth 1, row by row; the optical axis is in the image's middle."""
    focal = WIDTH / (2 * math.tan(FOV / 2))
    return np.array(
        [
            [(u - (WIDTH - 1) / 2) / focal, (v - (HEIGHT - 1) / 2) / focal, 1.0]
            for v in range(HEIGHT)
            for u in range(WIDTH)
        ]
    )


def depths(twin: Twin) -> Values:
    """Of each pixel [m]."""
    return cast(twin, pixels(), Rotation.from_euler("xyz", RPY) * OPTICAL)[0]


def depth_image(twin: Twin) -> Mapping[str, Any]:
    """sensor_msgs/Image."""
    return {
        "header": header(twin, "depth_link_optical"),
        "height": HEIGHT,
        "width": WIDTH,
        "encoding": "32FC1",
        "is_bigendian": 0,
        "step": 4 * WIDTH,
        "data": Records(depths(twin)[:, None], np.dtype("<f4")),
    }


def depth_points(twin: Twin) -> Mapping[str, Any]:
    """An organised cloud; NaN where there is no depth."""
    depth = depths(twin)
    points = pixels() * np.where(np.isfinite(depth), depth, math.nan)[:, None]
    layout = np.dtype([(axis, "<f4") for axis in "xyz"])
    return cloud(header(twin, "depth_link_optical"), layout, points, (HEIGHT, WIDTH))  # type: ignore[no-any-return]


def depth_info(twin: Twin) -> Mapping[str, Any]:
    """sensor_msgs/CameraInfo of a pinhole."""
    focal = WIDTH / (2 * math.tan(FOV / 2))
    k = np.array([[focal, 0.0, (WIDTH - 1) / 2], [0.0, focal, (HEIGHT - 1) / 2], [0.0, 0.0, 1.0]])
    roi = dict.fromkeys(("x_offset", "y_offset", "height", "width"), 0) | {"do_rectify": False}
    return {
        "header": header(twin, "depth_link_optical"),
        "height": HEIGHT,
        "width": WIDTH,
        "distortion_model": "plumb_bob",
        "d": np.zeros(5),
        "k": k.ravel(),
        "r": np.eye(3).ravel(),
        "p": np.column_stack([k, np.zeros(3)]).ravel(),
        "binning_x": 0,
        "binning_y": 0,
        "roi": roi,
    }
