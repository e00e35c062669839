"""What is read of a message's bytes is what rclpy's object of them says."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion, Vector3
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, LaserScan

from rover_metrics.ros.decoding import decoded
from rover_metrics.topics import SENSORS, stamp_ns

SOURCES = {source.message_type: source for source in SENSORS}
KINDS = {
    "sensor_msgs/msg/LaserScan": LaserScan,
    "sensor_msgs/msg/Imu": Imu,
    "geometry_msgs/msg/PoseArray": PoseArray,
    "nav_msgs/msg/Odometry": Odometry,
}
LARGEST = float(np.float32(3e38))  # rclpy refuses the very largest float32
NUMBERS = st.floats(-LARGEST, LARGEST, width=32) | st.sampled_from((math.nan, math.inf, -math.inf))
TEXTS = st.text("aZ/_ ä中😀", max_size=9)  # one to four bytes long
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)


class Taken:
    """A session that keeps what it is given."""

    def __init__(self) -> None:
        self.calls: list[str] = []

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        return lambda *values, **named: self.calls.append(repr((name, plain(values), plain(named))))


def plain(value: Any) -> Any:  # noqa: ANN401
    if isinstance(value, dict):
        return {name: plain(each) for name, each in value.items()}
    if hasattr(value, "__iter__"):
        return [plain(each) for each in value]
    return None if value is None else float(value)


@st.composite
def messages(draw: st.DrawFn) -> Any:  # noqa: ANN401
    """A message of one of the types, with texts and lists of any length."""
    message = draw(st.sampled_from(sorted(KINDS.values(), key=str)))()
    message.header.frame_id = draw(TEXTS)
    message.header.stamp.sec = draw(st.integers(-(2**31), 2**31 - 1))
    message.header.stamp.nanosec = draw(st.integers(0, 2**32 - 1))
    vectors = [Vector3(**dict(zip("xyz", draw(VECTORS), strict=True))) for _ in range(2)]
    if isinstance(message, LaserScan):
        message.angle_min, message.angle_increment, message.scan_time = draw(VECTORS)
        message.range_min, message.range_max, message.time_increment = draw(VECTORS)
        message.ranges.extend(draw(st.lists(NUMBERS, max_size=5)))
        message.intensities.extend(draw(st.lists(NUMBERS, max_size=3)))
    elif isinstance(message, Imu):
        message.angular_velocity, message.linear_acceleration = vectors
        message.orientation = Quaternion(x=draw(NUMBERS), w=draw(NUMBERS))
        message.orientation_covariance[0] = draw(st.sampled_from([-1.0, 0.0]))
    elif isinstance(message, PoseArray):
        places = draw(st.lists(VECTORS, max_size=2))
        message.poses = [Pose(position=Point(**dict(zip("xyz", p, strict=True)))) for p in places]
    else:
        message.child_frame_id = draw(TEXTS)
        message.twist.twist.linear, message.twist.twist.angular = vectors
    return message


@given(messages())
def test_a_session_is_given_the_same_of_bytes_as_of_an_object(message: Any) -> None:  # noqa: ANN401
    name = next(name for name, kind in KINDS.items() if isinstance(message, kind))
    data = serialize_message(message)
    told = []
    for read in (deserialize_message(data, type(message)), decoded(name, type(message), data)):
        SOURCES[name].take(taken := Taken(), read, stamp_ns(read))  # type: ignore[arg-type]
        told.append((stamp_ns(read), taken.calls))
    assert told[0] == told[1]
    assert told[0][1]


@given(st.integers(-(2**31), 2**31 - 1), st.integers(0, 2**32 - 1), st.integers(0, 12))
def test_a_time_is_what_rclpy_reads(sec: int, nanosec: int, length: int) -> None:
    data = serialize_message(clock := Clock(clock=Time(sec=sec, nanosec=nanosec)))
    assert decoded("rosgraph_msgs/msg/Clock", Clock, data) == clock
    if length < len(data):
        with pytest.raises(ValueError, match="no rosgraph_msgs/msg/Clock"):
            decoded("rosgraph_msgs/msg/Clock", Clock, data[:length])


@pytest.mark.parametrize("name", sorted(KINDS))
@pytest.mark.parametrize("data", [b"", b"\0\1\0\0", b"\0\1\0\0" + 12 * b"\xff", b"\0\7" + bytes(9)])
def test_what_is_no_message_is_left_out_with_a_reason(name: str, data: bytes) -> None:
    with pytest.raises(ValueError, match=f"no {name}"):
        decoded(name, KINDS[name], data)


def test_a_message_in_big_endian_is_read_by_rclpy() -> None:
    data = b"\0\0\0\0" + (5).to_bytes(4, "big") + bytes(4) + (1).to_bytes(4, "big") + bytes(400)
    read = decoded("sensor_msgs/msg/Imu", Imu, data)
    assert stamp_ns(read) == 5_000_000_000
    assert isinstance(read, Imu)
