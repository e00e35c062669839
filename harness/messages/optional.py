"""Readings of optional sensors as LaserScan, PointCloud2, Image, CameraInfo and GridMap.

Points are made here, in the process that publishes, so that the one that simulates is not kept from it.
Their layout is that of velodyne_pointcloud: x, y, z and intensity as float32, ring as uint16, time as
float32. The time is 0: all points of a cloud are of its stamp.
"""

from collections.abc import Callable, Mapping
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from harness.base.message_types import GRID_MAP, made
from harness.base.sim_time import NANOSECONDS
from harness.messages.blank import Message, cdr
from harness.messages.refilled import Fill, refilled, set_stamp
from harness.robots.frames.tree import ODOM
from harness.samples import Sample
from harness.sensors.camera.lens import Lens
from harness.sensors.camera.sensor import CameraOptions, CameraState
from harness.sensors.depth import DepthOptions
from harness.sensors.height_scan import HeightScan, HeightScanOptions
from harness.sensors.lidars import AS_NAN, CloudLidarOptions, PlanarLidarOptions
from harness.sensors.ranging import RangeReading

Draw = Callable[[CameraState], NDArray[np.uint8] | None]  # None: there is no OpenGL
ENCODING, CHANNELS = "rgb8", 3
# Reflectivities in percent, estimates: dry soil, rock. Neither range nor angle changes them.
ON_GROUND, ON_OBSTACLE = 25.0, 50.0
XYZ = ("x", "y", "z")
POINT = np.dtype([*((name, "<f4") for name in (*XYZ, "intensity")), ("ring", "<u2"), ("time", "<f4")])
FIELD = "sensor_msgs/msg/PointField"
FIELD_TYPES = {"<f4": 7, "<u2": 4}  # its FLOAT32 and UINT16
LAYER = "elevation"
PIXEL = np.dtype([(name, "<f4") for name in XYZ])


def laser_scan(message: Message, options: PlanarLidarOptions) -> Fill:
    """Returns what makes scans of readings, without intensities."""
    message.angle_min, message.angle_max = options.angle_min, options.angle_max
    message.angle_increment = (options.angle_max - options.angle_min) / (options.beams - 1)
    message.range_min, message.range_max = options.range_min, options.range_max
    return scan_fill(message)


def scan_fill(message: Message) -> Fill:
    """Returns what sets stamp and ranges; scan_time and time_increment stay 0, as in ros_gz_bridge."""
    return refilled(message, {"ranges": attrgetter("ranges")})


def lidar_cloud(message: Message, options: CloudLidarOptions) -> Fill:
    """Returns what makes clouds of readings."""
    shape = (options.rays // options.columns, options.columns) if options.organised else None
    whole = np.zeros(options.rays, POINT)
    whole["ring"] = options.ring
    keeps_misses = options.organised or options.misses == AS_NAN
    return _cloud(message, options.directions(), whole, shape, keeps_misses=keeps_misses)


def depth_cloud(message: Message, options: DepthOptions) -> Fill:
    """Returns what makes organised clouds of depth images, as depth_image_proc does."""
    whole = np.zeros(options.rays, PIXEL)
    shape = options.height, options.width
    return _cloud(message, options.directions(), whole, shape, keeps_misses=True)


def _cloud(
    message: Message,
    directions: np.ndarray,
    whole: np.ndarray,
    shape: tuple[int, int] | None,
    *,
    keeps_misses: bool,
) -> Fill:
    """What makes clouds along directions (n, 3) from all points with what does not change of them."""
    message.fields = [
        made(FIELD, name, offset, FIELD_TYPES[kind.str], 1)
        for name, (kind, offset, *_) in (whole.dtype.fields or {}).items()
    ]
    message.point_step = whole.dtype.itemsize
    exact = np.ascontiguousarray(directions.astype(np.float32).T)

    def fill(reading: RangeReading) -> bytes:
        set_stamp(message.header.stamp, reading.stamp_ns)
        hit = np.isfinite(reading.ranges)
        chosen = slice(None) if keeps_misses else hit
        points = whole[chosen]
        ranges = np.where(hit, reading.ranges, np.float32(np.nan))[chosen]
        for axis, name in enumerate(XYZ):
            points[name] = ranges * exact[axis][chosen]
        if whole.dtype == POINT:
            points["intensity"] = np.where(reading.on_obstacle[chosen], ON_OBSTACLE, ON_GROUND)
        message.height, message.width = shape or (1, len(points))
        message.row_step = message.width * message.point_step
        message.is_dense = bool(hit.all()) or not keeps_misses
        message.data = points.view(np.uint8)
        return cdr(message)

    return fill


def depth_image(message: Message, options: DepthOptions) -> Fill:
    """Returns what makes images of float32 depths [m], coded as REP-118 and REP-117 say."""
    message.height, message.width = options.height, options.width
    message.encoding, message.is_bigendian, message.step = "32FC1", 0, 4 * options.width

    def fill(reading: RangeReading) -> bytes:
        set_stamp(message.header.stamp, reading.stamp_ns)
        message.data = reading.ranges.view(np.uint8)
        return cdr(message)

    return fill


def image_fill(message: Message, options: CameraOptions, draw: Draw | None) -> Fill:
    """Returns a filler that has the image of each sample drawn; it gives None where there is no image.

    Args:
        message: A sensor_msgs/Image, filled again and again.
        options: The camera's.
        draw: Draws the scene of a sample; None where nothing can.
    """
    message.encoding, message.is_bigendian = ENCODING, 0
    message.width, message.height = options.width, options.height
    message.step = CHANNELS * options.width

    def fill(state: CameraState) -> bytes | None:
        pixels = None if draw is None else draw(state)
        if pixels is None:
            return None
        set_stamp(message.header.stamp, state.stamp_ns)
        message.data = pixels.ravel()
        return cdr(message)

    return fill


def lens_info(message: Message, lens: Lens) -> Fill:
    """Returns a filler of what is known of a lens, which is without further distortion."""
    message.width, message.height = lens.width, lens.height
    message.distortion_model = lens.distortion_model
    message.d = np.zeros(lens.coefficients)
    message.k = lens.matrix.ravel()
    message.r = np.eye(3).ravel()
    message.p = np.column_stack([lens.matrix, np.zeros(3)]).ravel()

    def fill(sample: Sample) -> bytes:
        set_stamp(message.header.stamp, sample.stamp_ns)
        return cdr(message)

    return fill


def grid_map_fill(options: HeightScanOptions) -> Callable[[HeightScan], bytes]:
    """Returns a filler of GridMaps of absolute heights, in odom, which is the world, as bytes.

    With axes `rover` the pose of the map is turned with the rover, which readers that know only its
    position leave out; with axes `world` it is not.
    """

    def fill(scan: HeightScan) -> bytes:
        heights = np.asarray(scan.heights + np.float32(scan.z), np.float32)
        place = (scan.x, scan.y, scan.yaw)
        return grid_map(scan.stamp_ns, ODOM, options.resolution, place, {LAYER: heights})

    return fill


def grid_map(
    stamp_ns: int,
    frame: str,
    resolution: float,
    place: tuple[float, float, float],
    layers: Mapping[str, NDArray[np.float32]],
) -> bytes:
    """Returns a GridMap as bytes; it counts rows against x, columns against y, stores column by column.

    Args:
        stamp_ns: Simulation time.
        frame: Of its pose.
        resolution: Side length of a cell [m].
        place: x, y of its middle [m], yaw [rad].
        layers: By name, rows with +x, columns with +y.
    """
    rows, columns = next(iter(layers.values())).shape
    dimensions = [
        made("std_msgs/msg/MultiArrayDimension", "column_index", columns, rows * columns),
        made("std_msgs/msg/MultiArrayDimension", "row_index", rows, rows),
    ]
    layout = made("std_msgs/msg/MultiArrayLayout", dimensions, 0)
    x, y, yaw = place
    turned = (0.0, 0.0, float(np.sin(yaw / 2)), float(np.cos(yaw / 2)))
    pose = made(
        "geometry_msgs/msg/Pose",
        made("geometry_msgs/msg/Point", x, y, 0.0),
        made("geometry_msgs/msg/Quaternion", *turned),
    )
    stamp = made("builtin_interfaces/msg/Time", *divmod(stamp_ns, NANOSECONDS))
    lengths = rows * resolution, columns * resolution
    arrays = (np.asarray(v[::-1, ::-1].ravel(order="F"), np.float32) for v in layers.values())
    message = made(
        GRID_MAP,
        made("std_msgs/msg/Header", stamp, frame),
        made("grid_map_msgs/msg/GridMapInfo", resolution, *lengths, pose),
        [*layers],
        [next(iter(layers))],
        [made("std_msgs/msg/Float32MultiArray", layout, values) for values in arrays],
        0,
        0,
    )
    return cdr(message)
