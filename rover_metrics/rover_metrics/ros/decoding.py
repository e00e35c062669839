"""Serialised messages -> those fields that the metrics are made of.

To read a few numbers takes a tenth of the time in which rclpy makes an object of a message. What is not
plain CDR in little endian, as everybody sends it on common machines, is left to rclpy.
"""

import struct
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock

from rover_metrics.topics import Message

START = 4  # [B]: the encapsulation, from behind which alignment counts
PLAIN_CDR = b"\x00\x01"  # its beginning
STAMP = struct.Struct("<iI")
HEADER = struct.Struct("<iII")  # its stamp, the length of its frame's name
LENGTH = struct.Struct("<I")
VECTOR = struct.Struct("<3d")
IMU = struct.Struct("<5d64x3d72x3d")  # orientation, first covariance; rates, accelerations
SCAN = struct.Struct("<7fI")
POSE_SIZE = (7 + 36) * 8  # [B] of a pose with its covariance


class _Stamp(NamedTuple):
    sec: int
    nanosec: int


class _Header(NamedTuple):
    stamp: _Stamp


class _Vector(NamedTuple):
    x: float
    y: float
    z: float


class _Quaternion(NamedTuple):
    x: float
    y: float
    z: float
    w: float


class _Imu(NamedTuple):
    header: _Header
    orientation: _Quaternion
    orientation_covariance: tuple[float]  # the first of them
    angular_velocity: _Vector
    linear_acceleration: _Vector


class _Scan(NamedTuple):
    header: _Header
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    ranges: NDArray[np.float32]


class _Pose(NamedTuple):
    position: _Vector


class _Poses(NamedTuple):
    header: _Header
    poses: tuple[_Pose, ...]  # the first, if there is any


class _Twist(NamedTuple):
    linear: _Vector


class _StampedTwist(NamedTuple):
    twist: _Twist


class _Odometry(NamedTuple):
    header: _Header
    twist: _StampedTwist


def _header(data: bytes) -> tuple[_Header, int]:
    """The header and where the next field may begin."""
    sec, nanosec, length = HEADER.unpack_from(data, START)
    return _Header(_Stamp(sec, nanosec)), START + HEADER.size + length


def _behind_text(data: bytes, at: int) -> int:
    return at + 4 + int(LENGTH.unpack_from(data, at)[0])


def _aligned(at: int, size: int) -> int:
    return at + -(at - START) % size


def _imu(data: bytes) -> _Imu:
    header, at = _header(data)
    x, y, z, w, first, *rest = IMU.unpack_from(data, _aligned(at, 8))
    return _Imu(header, _Quaternion(x, y, z, w), (first,), _Vector(*rest[:3]), _Vector(*rest[3:]))


def _scan(data: bytes) -> _Scan:
    header, at = _header(data)
    at = _aligned(at, 4)
    first, _, step, _, _, nearest, farthest, count = SCAN.unpack_from(data, at)
    ranges = np.frombuffer(data, "<f4", count, at + SCAN.size)
    return _Scan(header, first, step, nearest, farthest, ranges)


def _poses(data: bytes) -> _Poses:
    header, at = _header(data)
    at = _aligned(at, 4)
    if not LENGTH.unpack_from(data, at)[0]:
        return _Poses(header, ())
    return _Poses(header, (_Pose(_Vector(*VECTOR.unpack_from(data, _aligned(at + 4, 8)))),))


def _odometry(data: bytes) -> _Odometry:
    header, at = _header(data)
    pose = _aligned(_behind_text(data, _aligned(at, 4)), 8)
    twist = _Twist(_Vector(*VECTOR.unpack_from(data, pose + POSE_SIZE)))
    return _Odometry(header, _StampedTwist(twist))


def _clock(data: bytes) -> Clock:
    """A message of rclpy's own, as its time source takes no other."""
    message = Clock()
    message.clock.sec, message.clock.nanosec = STAMP.unpack_from(data, START)
    return message


READERS: dict[str, Callable[[bytes], Message]] = {
    "sensor_msgs/msg/LaserScan": _scan,
    "sensor_msgs/msg/Imu": _imu,
    "geometry_msgs/msg/PoseArray": _poses,
    "nav_msgs/msg/Odometry": _odometry,
    "rosgraph_msgs/msg/Clock": _clock,
}


def decoded(name: str, kind: type, data: bytes) -> Message:
    """Returns what is read of a message, under the names of its fields.

    Args:
        name: Its type, one of READERS.
        kind: rclpy's class for that.
        data: The message, serialised.

    Raises:
        ValueError: It is no such message.
    """
    try:
        if data.startswith(PLAIN_CDR):
            return READERS[name](data)
        return deserialize_message(data, kind)
    except (struct.error, RuntimeError) as error:  # RuntimeError: rclpy's
        raise ValueError(f"no {name}: {error}") from error
