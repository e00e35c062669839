"""What the metrics are told of a rover and of each sample."""

import math
from typing import Any
from unittest.mock import Mock, call, create_autospec

import numpy as np
import pytest

from harness.episode.metrics_feed import (
    DirectMetrics,
    SampleFeed,
    extended_parameters,
    extended_settings,
    outline_parameters,
    parameter_words,
)
from harness.robots import RoverSpec
from harness.samples import (
    GroundTruth,
    Imu,
    JointStates,
    LaserScan,
    Odometry,
    Pose,
    Sample,
    Tick,
    TruthState,
    Twist,
)
from harness.sensors.lidar_spec import LidarSpec
from rover_metrics import topics
from rover_metrics.session import MetricsSession
from tests.support.rovers import LEO, ROVER_ZERO4WD

# The rectangle around the wheels in models/README.md, and x of the lidar, which looks backwards.
OUTLINES = [(LEO, (-0.212, 0.218, 0.214), 0.174), (ROVER_ZERO4WD, (-0.272, 0.268, 0.223), 0.174)]
ATTITUDE = (0.1, 0.2, 0.3, 0.9)
RANGES = np.ones(5, dtype=np.float32)


@pytest.mark.parametrize(("rover", "edges", "lidar_x"), OUTLINES)
def test_a_node_is_told_the_footprint_and_the_pose_of_the_lidar(
    rover: RoverSpec, edges: tuple[float, float, float], lidar_x: float
) -> None:
    rear, front, side = edges
    settings = extended_settings(rover)
    told = outline_parameters(settings)
    corners = np.reshape(told["footprint"], (-1, 2)).tolist()
    expected = [[rear, -side], [rear, side], [front, -side], [front, side]]
    assert sorted(corners) == expected
    assert told["lidar_pose"] == [lidar_x, 0.0, math.pi]
    assert settings.gravity == 9.8
    assert extended_settings(rover, 1.62).gravity == 1.62
    assert settings.footprint is not None
    assert [list(corner) for corner in settings.footprint.corners] == corners
    words = parameter_words(extended_parameters(settings))
    assert words[:3] == ["--ros-args", "-p", "extended_columns:=true"]
    assert words[-1] == "--"
    assert "gravity:=9.8" in words
    assert f"lidar_pose:={told['lidar_pose']}" in words
    assert f"footprint:={told['footprint']}" in words


SAMPLES: tuple[Sample, ...] = (
    LaserScan(5, RANGES),
    Imu(5, ATTITUDE, (1.0, -2.0, 3.0), (4.0, 5.0, -6.0)),
    Pose(5, (1.0, 2.0, 3.0), ATTITUDE),
    Odometry(5, 1.0, 2.0, 3.0, Twist(-0.4, 0.7)),
    GroundTruth(5, 1.0, 2.0, 3.0, (-4.0, 5.0, 6.0), (7.0, 8.0, 9.0)),
    TruthState(5, True, False, True, 11.0, 12.0, 13.0, (0.1, 0.2, 0.3, 0.4), 14.0),
    JointStates(5, (1.0,), (2.0,), (3.0,)),
)
SCAN_ANGLES = (float(np.float32(-3.14159)), float(np.float32(2 * 3.14159 / 4)))  # as messages have them
CALLS: tuple[list[Any], ...] = (
    [call.take_scan(5, RANGES, angles=SCAN_ANGLES)],
    [call.take_imu(5, (4.0, 5.0, -6.0), (1.0, -2.0, 3.0), ATTITUDE)],
    [call.take_pose(5, (1.0, 2.0, 3.0))],
    [call.take_odometry(5, (-0.4, 0.0, 0.0))],
    [call.take_true_velocity((-4.0, 5.0, 6.0))],
    [
        call.take_contact(touches=True),
        call.take_traversal((11.0, False, True, 12.0, 13.0, 0.1, 0.2, 0.3, 0.4, 14.0)),
    ],
    [],
)


@pytest.fixture
def session() -> Mock:
    """A session with the extended columns that only remembers what it is given."""
    spy: Mock = create_autospec(MetricsSession, instance=True)
    spy.extended = object()
    return spy


@pytest.mark.parametrize(
    ("sample", "calls"), list(zip(SAMPLES, CALLS, strict=True)), ids=lambda value: type(value).__name__
)
def test_a_sample_arrives_as_it_would_out_of_its_message(
    sample: Sample, calls: list[Any], session: Mock
) -> None:
    SampleFeed(session, LidarSpec(beams=5)).take(sample)
    assert session.mock_calls == calls


def test_a_pose_array_without_a_pose_is_no_position(session: Mock) -> None:
    SampleFeed(session, LidarSpec()).take(Pose(5, (math.nan,) * 3, ATTITUDE, empty=True))
    assert session.mock_calls == [call.take_pose(5, None)]


def test_a_row_is_written_when_the_clock_tells_a_full_second_and_not_while_it_is_silent(
    session: Mock,
) -> None:
    log, second = Mock(), 1_000_000_000
    metrics = DirectMetrics(session, LidarSpec(), log)
    for stamp_ns, tells in (
        (second // 2, True),
        (second, False),
        (second + 1, True),
        (second + 2, True),
    ):
        tick = Tick(stamp_ns, (), tells)
        metrics.advance(tick, tick)
    assert session.row.mock_calls == [call(second + 1)]
    assert log.write.mock_calls == [call(metrics.last_row)]


def test_each_sample_counts_for_every_topic_that_it_would_have_had(session: Mock) -> None:
    sensors, truth = ([source.name for source in group] for group in (topics.SENSORS, topics.TRUTH))
    feed = SampleFeed(session, LidarSpec(beams=5))
    assert feed.fed == dict.fromkeys([*sensors, *truth], 0)
    for sample in (*SAMPLES, *SAMPLES, SAMPLES[0]):
        feed.take(sample)
    assert feed.fed == dict.fromkeys([*sensors, *truth], 2) | {"/scan": 3}
    session.extended = None
    twelve = SampleFeed(session, LidarSpec(beams=5))
    for sample in SAMPLES:
        twelve.take(sample)
    assert twelve.fed == dict.fromkeys(sensors, 1)
