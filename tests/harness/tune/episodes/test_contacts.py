"""Contacts as rows: where on the rover, and what the lidar had of the hazard."""

import math

import numpy as np
import pytest

from harness.robots.lidar import LidarSpec
from harness.samples import ContactEvent, LaserScan, PlacedScan, Pose
from harness.tune.episodes.recompute import event_rows, is_on, sight, zone
from harness.tune.episodes.record import Sight, Zone
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, orientation
from harness.world.world import World
from tests.support.rovers import LEO, ROVER_ZERO4WD

ANGLES = LidarSpec().angles


@pytest.mark.parametrize(
    ("point", "side"),
    [
        ((0.26, 0.0, 0.1), Zone.FRONT),
        ((-0.27, -0.1, 0.1), Zone.REAR),
        ((-0.2, -0.22, 0.1), Zone.SIDE),
        ((0.2, 0.16, 0.1), Zone.SIDE),  # 63 mm from the left edge, 68 mm from the front one
        ((0.2, 0.15, 0.1), Zone.FRONT),
        ((-0.2, 0.14, 0.1), Zone.REAR),
    ],
)
def test_a_point_belongs_to_the_nearest_edge(point: tuple[float, float, float], side: Zone) -> None:
    assert zone(point, ROVER_ZERO4WD) is side


def post(*, height: float, yaw: float = 0.0, level: float = 0.0) -> Obstacle:
    """0.2 m x 0.4 m, a metre ahead of the origin, on ground of a level [m]."""
    half, at = (0.1, 0.2, height / 2), (1.0, 0.0, level + height / 2)
    return Obstacle(
        ObstacleKind.HAZARD, shape="box", half_size=half, position=at, quaternion=orientation(yaw)
    )


def scanned(value: float, level: float = 0.0) -> PlacedScan:
    """A scan at the origin, or above, whose beam ahead (beam 0: the lidar looks back) says `value`."""
    ranges = np.full(640, np.inf, dtype=np.float32)
    ranges[0] = value
    return PlacedScan(LaserScan(0, ranges), Pose(0, (0.0, 0.0, level), (0.0, 0.0, 0.0, 1.0)))


LIDAR = LEO.lidar_height - 0.02  # [m]: what is lower may pass below the lidar's plane


@pytest.mark.parametrize(
    ("height", "value", "expected"),
    [
        (3.0, 0.9 - 0.174, Sight.SEEN),
        (3.0, 0.81 - 0.174, Sight.SEEN),
        (3.0, 0.79 - 0.174, Sight.MISSED),
        (3.0, 5.0, Sight.MISSED),
        (3.0, -math.inf, Sight.TOO_NEAR),
        (LIDAR - 1e-3, math.inf, Sight.TOO_LOW),
        (LIDAR + 1e-3, math.inf, Sight.MISSED),
        (0.5, -math.inf, Sight.TOO_LOW),
    ],
)
def test_what_the_lidar_had_of_a_hazard(height: float, value: float, expected: Sight) -> None:
    assert sight([scanned(math.inf), scanned(value)], post(height=height), LEO) is expected
    assert sight([scanned(value), scanned(math.inf)], post(height=height), LEO) is expected
    lifted = [scanned(value, level=7.0)]
    assert sight(lifted, post(height=height, level=7.0), LEO) is expected
    assert sight([], post(height=height), LEO) is Sight.MISSED


def test_points_next_to_a_turned_hazard_are_its_own() -> None:
    points = np.array([[1.25, 0.0], [1.0, 0.25], [1.0, 0.15], [1.19, 0.29], [1.21, 0.0], [1.0, 0.31]])
    assert is_on(post(height=1.0), points).tolist() == [False, True, True, True, False, False]
    turned = is_on(post(height=1.0, yaw=math.pi / 2), points)
    assert turned.tolist() == [True, False, True, False, True, False]
    slanted = points @ np.array([[math.cos(0.5), math.sin(0.5)], [-math.sin(0.5), math.cos(0.5)]])
    moved = slanted - (math.cos(0.5), math.sin(0.5)) + (1.0, 0.0)
    assert is_on(post(height=1.0, yaw=0.5), moved).tolist() == [False, True, True, True, False, False]
    at = (1.0, 0.5, 2.0)
    pole = Obstacle(kind=ObstacleKind.HAZARD, shape="cylinder", half_size=(0.1, 2.0), position=at)
    around = np.array([[1.19, 0.5], [1.0, 0.69], [1.21, 0.5], [1.0, 0.71]])
    assert is_on(pole, around).tolist() == [True, True, False, False]


def touch(start_s: float, end_s: float, other: str, kind: str = "hazard") -> ContactEvent:
    times, point = (round(start_s * 1e9), round(end_s * 1e9)), (0.26, 0.0, 0.1)
    return ContactEvent(kind, *times, "wheel_FL", other, 12.5, point)  # type: ignore[arg-type]  # kind


def test_a_row_tells_when_where_how_fast_and_what_the_scans_around_its_start_had() -> None:
    # A scan every 0.1 s; only those of 1.0 s and 3.0 s show the post, which is obstacle 1.
    ranges = {10: 0.9 - 0.174, 30: 0.9 - 0.174}
    scans = []
    for number in range(1, 41):
        placed = scanned(ranges.get(number, math.inf))
        scans.append(PlacedScan(LaserScan(number * 100_000_000, placed.scan.ranges), placed.pose))
    far = Obstacle(kind=ObstacleKind.ROCK, shape="box", half_size=(0.1,) * 3, position=(9.0, 9.0, 5.0))
    world = World("w", Heightfield(np.zeros((3, 3)), 10.0), (far, post(height=3.0)), 0, 0.5)
    speeds = np.arange(-19, 21, dtype=np.float16)
    events = [
        touch(1.5, 1.6, "hazard_1"),  # half a second after the scan
        touch(1.51, 1.6, "hazard_1"),
        touch(1.6, 1.7, "rock_0", kind="rock"),  # no hazard
        touch(2.81, 2.9, "hazard_1"),  # less than 0.2 s before the other scan
        touch(2.79, 2.9, "hazard_1"),
        touch(0.05, 0.1, "hazard_1"),  # before the first scan
        touch(2.85, 2.9, "hazard_0"),
    ]
    rows = event_rows(events, scans, speeds, world, LEO)
    assert rows["start_s"].tolist() == [1.5, 1.51, 2.81, 2.79, 0.05, 2.85]
    assert rows["end_s"].tolist() == [1.6, 1.6, 2.9, 2.9, 0.1, 2.9]
    seen, missed = Sight.SEEN, Sight.MISSED
    assert rows["sight"].tolist() == [seen, missed, seen, missed, missed, missed]  # last: another's
    assert rows["speed"].tolist() == [-6, -5, 8, 7, -19, 8]  # of the last scan before
    assert set(rows[["zone", "part", "force"]].tolist()) == {(Zone.FRONT, "wheel_FL", 12.5)}
    without = event_rows(events[:1], [], np.empty(0, np.float16), world, LEO)
    assert without["speed"].tolist() == [0.0]
