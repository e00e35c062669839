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

from tests.e2e.topic_oracle.form import header, in_limits, laser_scan, ray
from tests.e2e.topic_oracle.twin import Twin, Values

MOUNT, RPY = [0.1, -0.05, 0.3], [0.1, 0.2, -0.3]
NEAR, FAR = 0.3, 1.2  # [m]: on the stage some rays meet something nearer, some nothing
PLANAR = {"beams": 9, "angle_min": -2.4, "angle_max": 1.6}
RINGS, COLUMNS, LOWEST, HIGHEST = 3, 6, -0.6, 0.4
WIDTH, HEIGHT, FOV = 5, 4, 1.3
FOCAL = WIDTH / (2 * math.tan(FOV / 2))  # [pixels]
XYZI = ("x", "y", "z", "intensity")
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

    def __call__(self, told: object) -> bool:
        """Whether these are the bytes of a message."""
        records = np.frombuffer(bytes(told), self.layout)  # type: ignore[call-overload]
        names = self.layout.names
        columns = [records[name] for name in names] if names else [records]
        found = np.column_stack([column.astype(float) for column in columns])
        return found.shape == self.values.shape and np.allclose(
            found, self.values, 0.0, CLOSE, equal_nan=True
        )


def cast(twin: Twin, directions: Values, turn: Rotation) -> tuple[Values, Values]:
    """How often vectors of the sensor's frame fit up to what they meet, and its intensities."""
    data, origin = twin.at_present(), twin.data.qpos[:3] + twin.attitude.apply(MOUNT)
    ranges, intensities = [], []
    for direction in directions:
        length = float(np.linalg.norm(direction))
        distance, geom = ray(twin, data, origin, (twin.attitude * turn).apply(direction / length))
        ranges.append(in_limits(distance / length, NEAR, FAR))
        met = geom >= 0 and twin.model.geom(geom).type[0] != mujoco.mjtGeom.mjGEOM_HFIELD
        intensities.append(THING if met else EARTH)
    return np.array(ranges), np.array(intensities)


def spherical(azimuth: float, elevation: float) -> Values:
    """A unit vector."""
    level = math.cos(elevation)
    return np.array([level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)])


def planar_scan(twin: Twin) -> Mapping[str, Any]:
    """The lidar that scans a plane."""
    angles = np.linspace(PLANAR["angle_min"], PLANAR["angle_max"], int(PLANAR["beams"]))
    directions = np.array([spherical(angle, 0.0) for angle in angles])
    ranges, _ = cast(twin, directions, Rotation.from_euler("xyz", RPY))
    return laser_scan(header(twin, "lidar2d_link"), angles, (NEAR, FAR), ranges, 0)


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
    layout = np.dtype([*((name, "<f4") for name in XYZI), ("ring", "<u2"), ("time", "<f4")])
    return cloud(header(twin, "lidar3d_link"), layout, points, (1, len(points)))  # type: ignore[no-any-return]


def pixels() -> Values:
    """What each pixel looks at, of depth 1, row by row; the optical axis is in the image's middle."""
    u, v = np.meshgrid(np.arange(WIDTH) - (WIDTH - 1) / 2, np.arange(HEIGHT) - (HEIGHT - 1) / 2)
    return np.column_stack([u.ravel() / FOCAL, v.ravel() / FOCAL, np.ones(u.size)])


def depths(twin: Twin) -> Values:
    """Of each pixel [m]."""
    return cast(twin, pixels(), Rotation.from_euler("xyz", RPY) * OPTICAL)[0]


def depth_image(twin: Twin) -> Mapping[str, Any]:
    """sensor_msgs/Image."""
    return {
        "header": header(twin, "depth_optical_frame"),
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
    return cloud(header(twin, "depth_optical_frame"), layout, points, (HEIGHT, WIDTH))  # type: ignore[no-any-return]


def depth_info(twin: Twin) -> Mapping[str, Any]:
    """sensor_msgs/CameraInfo of a pinhole."""
    k = np.array([[FOCAL, 0.0, (WIDTH - 1) / 2], [0.0, FOCAL, (HEIGHT - 1) / 2], [0.0, 0.0, 1.0]])
    roi = dict.fromkeys(("x_offset", "y_offset", "height", "width"), 0) | {"do_rectify": False}
    return {
        "header": header(twin, "depth_optical_frame"),
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
