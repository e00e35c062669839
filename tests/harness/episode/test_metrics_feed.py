"""What the metrics know of a rover; that samples arrive as messages would, golden runs show."""

import math

import numpy as np
import pytest

from harness.episode.metrics_feed import SampleFeed, extended_settings
from harness.robots import RoverSpec
from harness.robots.lidar import LidarSpec
from harness.samples import Odometry, Pose, Sample, TruthState, Twist
from harness.sensors.battery import Battery
from rover_metrics.session import MetricsSession
from tests.support.rovers import LEO, ROVER_ZERO4WD

# The rectangle around the wheels in models/README.md, and x of the lidar, which looks backwards.
OUTLINES = [(LEO, (-0.212, 0.218, 0.214), 0.174), (ROVER_ZERO4WD, (-0.272, 0.268, 0.223), 0.174)]


@pytest.mark.parametrize(("rover", "edges", "lidar_x"), OUTLINES)
def test_the_settings_of_a_rover_are_its_footprint_lidar_gravity_and_wheels(
    rover: RoverSpec, edges: tuple[float, float, float], lidar_x: float
) -> None:
    rear, front, side = edges
    settings = extended_settings(rover)
    assert settings.footprint is not None
    corners = [(rear, -side), (rear, side), (front, -side), (front, side)]
    assert sorted(settings.footprint.corners) == pytest.approx(np.array(corners))
    pose = settings.lidar_pose
    assert (pose.x, pose.y, pose.yaw) == (lidar_x, 0.0, math.pi)
    assert settings.gravity == 9.8
    assert extended_settings(rover, 1.62).gravity == 1.62
    assert settings.wheels.split(",") == list(rover.wheel_names)


def test_each_sample_counts_for_every_topic_that_it_would_have_had() -> None:
    state = TruthState(5, True, False, True, 11.0, 12.0, 13.0, (0.1, 0.2, 0.3, 0.4), 14.0)
    empty = Pose(5, (math.nan,) * 3, (0.0, 0.0, 0.0, 1.0), empty=True)
    packs = [Battery(5, name, 12.0, -2.0, 1.0, 1.0, 0.0, (1.0, 1.0)) for name in ("battery", "spare")]
    for settings, truth in ((None, 0), (extended_settings(LEO, energy=True), 1)):
        session = MetricsSession(settings=settings)
        feed = SampleFeed(session, LidarSpec(beams=5))
        samples: list[Sample] = [state, empty, Odometry(5, 1.0, 2.0, 3.0, Twist(-0.4, 0.7)), *packs]
        for sample in samples:
            feed.take(sample)
        assert feed.fed["/rover/pose_array"] == feed.fed["/odometry/wheels"] == 1
        assert feed.fed["/scan"] == 0
        for topic in ("/rover/truth/contact", "/rover/truth/traversal", "/battery/battery_state"):
            assert feed.fed.get(topic, 0) == truth
