"""Serialised messages -> those fields that the metrics are made of.

To read a few numbers takes a tenth of the time in which rclpy makes an object of a message. What is not
plain CDR in little endian, as everybody sends it on common machines, is left to rclpy.
"""

import struct
from collections import namedtuple
from collections.abc import Callable

import numpy as np
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


# Those fields that are read, under rclpy's names.
_Stamp = namedtuple("_Stamp", "sec nanosec")
_Header = namedtuple("_Header", "stamp")
_Vector = namedtuple("_Vector", "x y z")
_Quaternion = namedtuple("_Quaternion", "x y z w")
_Imu = namedtuple(
    "_Imu", "header orientation orientation_covariance angular_velocity linear_acceleration"
)  # of the covariances the first
_Scan = namedtuple("_Scan", "header angle_min angle_increment range_min range_max ranges")
_Pose = namedtuple("_Pose", "position")
_Poses = namedtuple("_Poses", "header poses")  # the first, if there is any
_Twist = namedtuple("_Twist", "linear")
_StampedTwist = namedtuple("_StampedTwist", "twist")
_Odometry = namedtuple("_Odometry", "header twist")


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
    """Returns a message, or what is read of it under the names of its fields.

    Args:
        name: Its type, of one of READERS in full.
        kind: rclpy's class for that.
        data: The message, serialised.

    Raises:
        ValueError: It is no such message.
    """
    try:
        if name in READERS and data.startswith(PLAIN_CDR):
            return READERS[name](data)
        return deserialize_message(data, kind)
    except (struct.error, RuntimeError) as error:  # RuntimeError: rclpy's
        raise ValueError(f"no {name}: {error}") from error
