"""Which message becomes which sample; messages are of the same shape as ROS's, without it."""

import array
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock, call, create_autospec

import pytest
from rosbags.typesys import Stores, get_typestore

from rover_metrics.extended.traffic_columns import TOPICS
from rover_metrics.health.rejections import NO_TIME
from rover_metrics.session import MetricsSession, Remark
from rover_metrics.topics import CLOCK, SENSORS, TRUTH, Message, Source, stamp_ns

SCAN, IMU, POSE, ODOMETRY = SENSORS
GROUND_TRUTH, CONTACT, TRUTH_VALUES = TRUTH
STAMP_NS = 3_000_000_005
RANGES = array.array("f", (2.5, 1.0))


def vector(*values: float) -> Message:
    return SimpleNamespace(**dict(zip("xyzw", values, strict=False)))


def stamped(**fields: object) -> Message:
    stamp = SimpleNamespace(sec=3, nanosec=5)
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp), **fields)


def scan() -> Message:
    angles = {"angle_min": -3.0, "angle_max": 3.0, "angle_increment": 0.25}
    return stamped(ranges=RANGES, range_min=0.15, range_max=10.0, **angles)


def imu(*, first_covariance: float = 0.0) -> Message:
    return stamped(
        linear_acceleration=vector(1.0, 2.0, 3.0),
        angular_velocity=vector(4.0, 5.0, 6.0),
        orientation=vector(0.1, 0.2, 0.3, 0.4),
        orientation_covariance=[first_covariance, *[-1.0] * 8],
    )


def poses(*positions: tuple[float, float, float]) -> Message:
    return stamped(poses=[SimpleNamespace(position=vector(*position)) for position in positions])


def odometry() -> Message:
    twist = SimpleNamespace(linear=vector(1.0, 2.0, 3.0), angular=vector(7.0, 8.0, 9.0))
    return stamped(twist=SimpleNamespace(twist=twist))


def values(*labels: str) -> Message:
    dim = [SimpleNamespace(label=label) for label in labels]
    return SimpleNamespace(data=array.array("d", (0.5, 1.5)), layout=SimpleNamespace(dim=dim))


ACCELERATION, RATE = (1.0, 2.0, 3.0), (4.0, 5.0, 6.0)


@pytest.mark.parametrize(
    ("source", "message", "expected"),
    [
        (
            SCAN,
            scan(),
            call.take_scan(STAMP_NS, RANGES, angles=(-3.0, 0.25), limits=(0.15, 10.0)),
        ),
        (IMU, imu(), call.take_imu(STAMP_NS, ACCELERATION, RATE, (0.1, 0.2, 0.3, 0.4))),
        (
            IMU,
            imu(first_covariance=-0.5),  # wrong, but not the value
            call.take_imu(STAMP_NS, ACCELERATION, RATE, (0.1, 0.2, 0.3, 0.4)),
        ),
        # which says that there is no orientation
        (IMU, imu(first_covariance=-1.0), call.take_imu(STAMP_NS, ACCELERATION, RATE, None)),
        # the first is the rover's
        (POSE, poses((1.0, 2.0, 3.0), (9.0, 9.0, 9.0)), call.take_pose(STAMP_NS, (1.0, 2.0, 3.0))),
        (POSE, poses(), call.take_pose(STAMP_NS, None)),
        (ODOMETRY, odometry(), call.take_odometry(STAMP_NS, (1.0, 2.0, 3.0))),
        (GROUND_TRUTH, odometry(), call.take_true_velocity((1.0, 2.0, 3.0))),
        (CONTACT, SimpleNamespace(data=True), call.take_contact(touches=True)),
        (CONTACT, SimpleNamespace(data=False), call.take_contact(touches=False)),
        (TRUTH_VALUES, values(), call.take_traversal([0.5, 1.5], None)),
        (TRUTH_VALUES, values(""), call.take_traversal([0.5, 1.5], None)),
        (TRUTH_VALUES, values("speed,slip", "x"), call.take_traversal([0.5, 1.5], ["speed", "slip"])),
    ],
)
def test_a_message_is_one_sample_and_what_the_session_remarks_is_told(
    source: Source,
    message: Message,
    expected: Any,  # noqa: ANN401 - mock's calls have no public type
) -> None:
    session: Mock = create_autospec(MetricsSession, instance=True)
    getattr(session, expected[0]).return_value = remark = Remark("odd")
    assert source.take(session, message, STAMP_NS) is remark
    assert session.mock_calls == [expected]


@pytest.mark.parametrize(
    ("sec", "nanosec", "is_odd"),
    [(0, 0, False), (9, 999_999_999, False), (-1, 5, True), (9, 10**9, True)],
)
def test_a_clock_that_tells_no_time_is_remarked_upon(sec: int, nanosec: int, is_odd: bool) -> None:
    session: Mock = create_autospec(MetricsSession, instance=True)
    message = SimpleNamespace(clock=SimpleNamespace(sec=sec, nanosec=nanosec))
    remark = CLOCK.take(session, message, 0)
    assert (remark is not None) is is_odd
    if remark is not None:
        assert (remark.what, remark.left_out) == (NO_TIME, True)
    assert session.mock_calls == []
    assert (CLOCK.name, CLOCK.message_type) == ("/clock", "rosgraph_msgs/msg/Clock")


def test_a_stamp_is_the_headers_in_nanoseconds() -> None:
    assert stamp_ns(scan()) == STAMP_NS


def test_every_type_exists_and_has_a_header_where_the_table_says_so() -> None:
    types = get_typestore(Stores.LATEST).types
    for source in (*SENSORS, *TRUTH, CLOCK):
        fields = types[source.message_type].__annotations__
        assert ("header" in fields) is source.has_stamp


def test_sensors_are_those_whose_traffic_has_columns_and_truth_is_what_simulators_publish() -> None:
    assert tuple(source.topic for source in SENSORS) == TOPICS
    assert [source.topic for source in TRUTH] == [None, None, None]
    assert [source.name for source in SENSORS] == [
        *("/scan", "/imu/data", "/rover/pose_array", "/odometry/wheels")
    ]
    assert [source.name for source in TRUTH] == [
        *("/odom_ground_truth", "/rover/truth/contact", "/rover/truth/traversal")
    ]
    assert [source.is_truth for source in (*SENSORS, *TRUTH)] == [False] * 4 + [True] * 3
    assert [source.name for source in (*SENSORS, *TRUTH) if source.best_effort] == ["/rover/pose_array"]
