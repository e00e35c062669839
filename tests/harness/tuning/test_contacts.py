"""Contacts as rows: where on the rover, and what the lidar had of the hazard."""

import math

import numpy as np
import pytest

from harness.config import EpisodeConfig
from harness.report.recorder import PlacedScan
from harness.robots import LEO, ROVER_ZERO4WD
from harness.samples import LaserScan, Pose
from harness.sensors.lidar_spec import LidarSpec
from harness.tuning.contacts import is_on, sight, zone
from harness.tuning.drive import drive
from harness.tuning.record import Sight, Zone
from harness.tuning.store import encode
from harness.world.obstacles import Obstacle, ObstacleKind, orientation

ANGLES = LidarSpec().angles


@pytest.mark.parametrize(
    ("point", "side"),
    [
        ((0.26, 0.0, 0.1), Zone.FRONT),
        ((0.26, 0.2, 0.1), Zone.FRONT),
        ((-0.27, -0.1, 0.1), Zone.REAR),
        ((0.1, 0.22, 0.1), Zone.SIDE),
        ((-0.2, -0.22, 0.1), Zone.SIDE),
    ],
)
def test_a_point_belongs_to_the_nearest_edge(point: tuple[float, float, float], side: Zone) -> None:
    assert zone(point, ROVER_ZERO4WD) is side


def post(*, height: float, yaw: float = 0.0) -> Obstacle:
    """0.2 m x 0.4 m, a metre ahead of the origin."""
    return Obstacle(
        kind=ObstacleKind.HAZARD,
        shape="box",
        half_size=(0.1, 0.2, height / 2),
        position=(1.0, 0.0, height / 2),
        quaternion=orientation(yaw),
    )


def scanned(value: float) -> PlacedScan:
    """A scan at the origin whose beam ahead (beam 0, for the lidar looks back) says `value`."""
    ranges = np.full(640, np.inf, dtype=np.float32)
    ranges[0] = value
    return PlacedScan(LaserScan(0, ranges), Pose(0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)))


@pytest.mark.parametrize(
    ("height", "value", "expected"),
    [
        (3.0, 0.9 - 0.174, Sight.SEEN),
        (3.0, 5.0, Sight.MISSED),
        (3.0, -math.inf, Sight.TOO_NEAR),
        (0.5, math.inf, Sight.TOO_LOW),
        (0.5, -math.inf, Sight.TOO_LOW),
    ],
)
def test_what_the_lidar_had_of_a_hazard(height: float, value: float, expected: Sight) -> None:
    assert sight([scanned(math.inf), scanned(value)], post(height=height), LEO) is expected


def test_points_next_to_a_turned_hazard_are_its_own() -> None:
    points = np.array([[1.25, 0.0], [1.0, 0.25], [1.0, 0.15]])

    assert is_on(post(height=1.0), points).tolist() == [False, True, True]
    assert is_on(post(height=1.0, yaw=math.pi / 2), points).tolist() == [True, False, True]


@pytest.mark.parametrize(("driver", "side"), [("ram", Zone.FRONT), ("reverse_into", Zone.REAR)])
def test_a_driven_episode_has_the_contacts_that_its_driver_seeks(driver: str, side: Zone) -> None:
    config = EpisodeConfig(terrain="posts", robot="rover_zero4wd", driver=driver, seed=3, duration=40.0)

    record = drive(config)

    assert len(record.scans) == 800
    assert len(record.windows) == 40
    assert side in record.events["zone"]
    during = np.logical_or.reduce(
        [
            (record.times > start) & (record.times <= end)
            for start, end in record.events[["start_s", "end_s"]]
        ]
    )
    assert record.scans["contact"][during].all()
    assert record.windows["largest_stride"].max() < 0.2
    assert (record.windows["largest_step"] <= record.windows["largest_stride"] + 1e-3).all()


def test_the_same_episode_gives_the_same_bytes() -> None:
    config = EpisodeConfig(terrain="gravel", driver="roam", seed=3, duration=5.0)

    assert encode(drive(config)) == encode(drive(config))
