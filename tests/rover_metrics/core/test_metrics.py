import array
import csv
import io
import itertools
import math
import random
import struct
from collections.abc import Sequence
from dataclasses import asdict, replace
from statistics import fmean

import numpy as np
import pytest

from rover_metrics.core.metrics import TraversalMetrics, Vector3
from rover_metrics.core.row import COLUMNS, Row
from rover_metrics.core.thresholds import Thresholds

STILL = (0.0, 0.0, 0.0)
INF = math.inf
NAN = math.nan


@pytest.fixture
def metrics() -> TraversalMetrics:
    return TraversalMetrics()


def csv_line(row: Row) -> str:
    text = io.StringIO(newline="")
    csv.writer(text).writerow(row.as_fields())
    return text.getvalue()


# The row


def test_the_row_before_any_sample_is_roboterrains_to_the_byte(metrics: TraversalMetrics) -> None:
    expected = "1737047098,0,0,0.0,0,inf,0.0,0,0,0,0,Normal operation\r\n"
    assert csv_line(metrics.row(1737047098)) == expected
    assert (metrics.clearance, metrics.farthest) == (INF, -INF)


def test_a_row_of_hand_computed_values(metrics: TraversalMetrics) -> None:
    metrics.add_scan([3.0, 0.125, INF])  # collision
    metrics.add_scan([3.0, 0.5])
    metrics.add_imu((0.0, 3.0, 4.0), (0.0, 0.0, 2.0))  # 5 + 2
    metrics.add_imu((12.0, 0.0, -16.0), (1.0, 0.0, 0.0))  # 20 + 1, rough
    metrics.add_pose((1.0, 1.0, 1.0))
    metrics.add_pose((1.1, 1.2, 1.2))  # 0.3
    metrics.add_odometry((0.3, 0.4, 0.0))  # 0.5
    metrics.add_odometry((-1.0, 0.0, 0.0))  # 1.0
    expected = "7,1,0,28.0,14.0,0.3125,0.3,0.75,20.0,1,16.0,Normal operation\r\n"
    assert csv_line(metrics.row(7)) == expected


def test_a_row_has_roboterrains_columns_in_roboterrains_order(metrics: TraversalMetrics) -> None:
    row = metrics.row(0)
    assert row.columns == COLUMNS
    assert row.columns == (
        "Timestamp",
        "Total Collisions",
        "Current Collision Status",
        "Smoothness Metric",
        "Current Smoothness",
        "Obstacle Clearance",
        "Distance Traveled",
        "Current Velocity",
        "IMU Acceleration Magnitude",
        "Is Rough Terrain",
        "Vertical Roughness",
        "Notes",
    )


def test_floats_are_rounded_to_four_decimals_and_counts_stay_integers() -> None:
    row = Row(3, 4, 1, 1.00005, 2.123449, 1 / 3, 0.0, 10.0, 1e16, 0, 9.8, "note, with comma")
    assert csv_line(row) == ('3,4,1,1.0001,2.1234,0.3333,0.0,10.0,1e+16,0,9.8,"note, with comma"\r\n')


def test_a_mean_of_zero_is_a_float_where_an_empty_window_is_an_integer(
    metrics: TraversalMetrics,
) -> None:
    metrics.add_odometry(STILL)
    metrics.add_imu(STILL, STILL)
    assert csv_line(metrics.row(0)) == "0,0,0,0.0,0.0,inf,0.0,0.0,0.0,0,0.0,Normal operation\r\n"


def test_extended_cells_follow_the_twelve_and_what_is_none_is_empty(metrics: TraversalMetrics) -> None:
    row = replace(metrics.row(3), extended={"Way [m]": None, "Share": 0.123456, "Count": 0})
    assert row.columns == (*COLUMNS, "Way [m]", "Share", "Count")
    assert row.as_fields() == (*metrics.row(3).as_fields(), "", 0.1235, 0)


# All columns at once


class History:
    """Everything that was ever given, and RoboTerrain's definitions of the columns over it."""

    def __init__(self, thresholds: Thresholds) -> None:
        self.thresholds = thresholds
        self.scans: list[list[float]] = []
        self.imu: list[tuple[float, float, float]] = []  # |a|, |w|, az
        self.path: list[Vector3] = []
        self.speeds: list[float] = []

    def row(self) -> dict[str, object]:
        limits = self.thresholds
        nearest = [min(scan) for scan in self.scans]
        clearance = fmean(nearest[-100:]) if nearest else INF
        steps = [math.dist(*pair) for pair in itertools.pairwise(self.path)]
        accel, _, vertical = self.imu[-1] if self.imu else (0.0, 0.0, 0.0)
        smoothness = [a + w for a, w, _ in self.imu]
        return {
            "stamp_s": 7,
            "total_collisions": sum(value < limits.collision_threshold for value in nearest),
            "collision_status": int(clearance < limits.collision_threshold),
            "smoothness_metric": pytest.approx(sum(smoothness), rel=1e-12),
            "current_smoothness": pytest.approx(fmean(smoothness[-100:] or [0.0]), rel=1e-12),
            "obstacle_clearance": pytest.approx(clearance, rel=1e-12),
            "distance_traveled": pytest.approx(
                sum(s for s in steps if s < limits.distance_threshold), rel=1e-12
            ),
            "current_velocity": pytest.approx(fmean(self.speeds[-100:] or [0.0]), rel=1e-12),
            "imu_acceleration_magnitude": accel,
            "is_rough_terrain": int(accel > limits.rough_terrain_threshold),
            "vertical_roughness": abs(vertical),
            "notes": "Normal operation",
        }


LIMITS = Thresholds(
    collision_threshold=0.5,
    smoothness_threshold=1.0,
    min_safe_clearance=1.5,
    distance_threshold=2.5,
    rough_terrain_threshold=7.0,
)
# Quadruples of Pythagoras: magnitudes are exact, and some are at a threshold.
VECTORS: list[Vector3] = [
    (0.0, 0.0, 0.0),
    *itertools.permutations((2.0, 3.0, -6.0), 3),  # 7
    *itertools.permutations((-1.0, 4.0, 8.0), 3),  # 9
    *itertools.permutations((1.0, 2.0, -2.0), 3),  # 3
    *itertools.permutations((0.0, 1.5, 2.0), 3),  # 2.5
]
RANGES = (NAN, INF, -INF, -1.0, 0.0, 0.25, 0.5, 0.5, 0.75, 1.25, 9.5)


@pytest.mark.parametrize("limits", [LIMITS, Thresholds(collision_threshold=0.75)])
def test_every_column_is_what_its_definition_says_of_all_samples_so_far(limits: Thresholds) -> None:
    rng = random.Random(5)  # noqa: S311 - no secrets here
    metrics, history = TraversalMetrics(limits), History(limits)
    for number in range(900):
        if number == 450:  # from here on the mean of a window passes the threshold
            ranges: Sequence[float] = (0.25, 0.5)
        elif number < 450:
            ranges = RANGES
        kind = rng.randrange(4) if number else 0
        if kind == 0:
            # The first is at the threshold, and so is the mean then.
            scan = rng.choices(ranges, k=rng.randrange(5)) if number else [limits.collision_threshold]
            finite = [value for value in scan if math.isfinite(value)]
            assert metrics.add_scan(scan) is bool(finite)
            history.scans += [finite] if finite else []
            if history.scans:
                assert metrics.clearance == min(history.scans[-1])
                assert metrics.farthest == max(history.scans[-1])
        elif kind == 1:
            a, w = rng.choice(VECTORS), rng.choice(VECTORS)
            assert metrics.add_imu(a, w)
            history.imu.append((math.dist(a, STILL), math.dist(w, STILL), a[2]))
        elif kind == 2:
            at = rng.choice(VECTORS)
            position = history.path[-1] if history.path and number % 3 else STILL
            position = (position[0] + at[0], position[1] + at[1], position[2] + at[2])
            assert metrics.add_pose(position)
            history.path.append(position)
            assert metrics.last_step == (math.dist(*history.path[-2:]) if history.path[1:] else 0.0)
        else:
            velocity = rng.choice(VECTORS)
            assert metrics.add_odometry(velocity)
            history.speeds.append(math.dist(velocity, STILL))
        assert asdict(metrics.row(7)) == {**history.row(), "extended": {}}
    assert all(len(kept) > 150 for kept in (history.scans, history.imu, history.path, history.speeds))


def test_a_float_that_no_float32_is_counts_as_the_one_that_a_message_would_carry(
    metrics: TraversalMetrics,
) -> None:
    metrics.add_scan([1 / 3])
    assert metrics.clearance == struct.unpack("f", struct.pack("f", 1 / 3))[0] != 1 / 3


# Scans


@pytest.mark.parametrize("ranges", [[INF, INF], [-INF], [NAN], [INF, -INF, NAN], []])
def test_a_scan_without_a_finite_range_changes_nothing(
    metrics: TraversalMetrics, ranges: list[float]
) -> None:
    metrics.add_scan([0.125])
    before = metrics.row(0)
    assert not metrics.add_scan(ranges)
    assert metrics.clearance == 0.125
    assert metrics.row(0) == before


def test_a_collision_is_strictly_below_the_threshold() -> None:
    metrics = TraversalMetrics(Thresholds(collision_threshold=0.25))
    metrics.add_scan([0.25])
    assert metrics.total_collisions == 0
    metrics.add_scan([np.nextafter(np.float32(0.25), np.float32(0))])
    assert metrics.total_collisions == 1


def test_a_float32_range_of_0_2_is_no_collision_for_it_is_a_little_more(
    metrics: TraversalMetrics,
) -> None:
    metrics.add_scan(np.array([0.2], dtype=np.float32))
    metrics.add_scan([0.2])
    assert metrics.total_collisions == 0
    assert metrics.row(0).collision_status == 0


def test_ranges_give_the_same_row_in_whatever_container_they_come(
    metrics: TraversalMetrics,
) -> None:
    rng = np.random.default_rng(1)
    scans = rng.uniform(0.15, 10.0, (150, 64)).astype(np.float32)
    as_message, as_list = TraversalMetrics(), TraversalMetrics()
    for scan in scans:
        metrics.add_scan(scan)
        as_message.add_scan(array.array("f", scan.tobytes()))
        as_list.add_scan(scan.astype(np.float64).tolist())
    assert metrics.row(1) == as_message.row(1) == as_list.row(1)
    expected = np.mean(scans[-100:].min(axis=1).astype(np.float64))
    assert metrics.row(1).obstacle_clearance == pytest.approx(expected, abs=1e-12)


def test_a_scan_is_only_read(metrics: TraversalMetrics) -> None:
    scan = np.array([1.0, INF, 0.5], dtype=np.float32)
    scan.setflags(write=False)
    assert metrics.add_scan(scan)


# IMU


def test_rough_terrain_is_strictly_above_the_threshold(metrics: TraversalMetrics) -> None:
    metrics.add_imu((9.0, 12.0, 0.0), STILL)
    assert metrics.row(0).is_rough_terrain == 0
    metrics.add_imu((9.0, 12.0, 0.01), STILL)
    assert metrics.row(0).is_rough_terrain == 1


@pytest.mark.parametrize("bad", [NAN, INF, -INF])
@pytest.mark.parametrize("where", range(6))
def test_an_imu_sample_that_is_not_finite_is_left_out(
    metrics: TraversalMetrics, bad: float, where: int
) -> None:
    metrics.add_imu((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    before = metrics.row(0)
    values = [1.0] * 6
    values[where] = bad
    assert not metrics.add_imu((values[0], values[1], values[2]), (values[3], values[4], values[5]))
    assert metrics.row(0) == before


# Pose


@pytest.mark.parametrize(("step", "counted"), [(0.4999, True), (0.5, False), (3e6, False)])
def test_a_step_counts_strictly_below_the_distance_threshold(
    metrics: TraversalMetrics, step: float, counted: bool
) -> None:
    metrics.add_pose(STILL)
    metrics.add_pose((step, 0.0, 0.0))
    assert metrics.total_distance == (step if counted else 0.0)
    assert metrics.last_step == step
    metrics.add_pose((step + 0.25, 0.0, 0.0))  # from where the jump ended
    assert metrics.total_distance == pytest.approx(0.25 + (step if counted else 0.0))


@pytest.mark.parametrize("bad", [(NAN, 0.0, 0.0), (0.0, INF, 0.0), (0.0, 0.0, -INF)])
def test_a_pose_that_is_not_finite_is_left_out(
    metrics: TraversalMetrics, bad: tuple[float, float, float]
) -> None:
    metrics.add_pose(STILL)
    assert not metrics.add_pose(bad)
    metrics.add_pose((0.25, 0.0, 0.0))
    assert metrics.total_distance == 0.25


# Odometry


@pytest.mark.parametrize("bad", [(NAN, 0.0, 0.0), (0.0, INF, 0.0), (0.0, 0.0, -INF)])
def test_odometry_that_is_not_finite_is_left_out(
    metrics: TraversalMetrics, bad: tuple[float, float, float]
) -> None:
    assert not metrics.add_odometry(bad)
    assert metrics.row(0).current_velocity == 0


# Windows and thresholds


def test_new_thresholds_hold_for_what_follows(metrics: TraversalMetrics) -> None:
    metrics.add_scan([0.75])
    metrics.add_imu((5.0, 0.0, 0.0), STILL)
    metrics.thresholds = Thresholds(
        collision_threshold=1.0, rough_terrain_threshold=4.0, distance_threshold=2.0
    )
    assert metrics.row(0).collision_status == 1
    assert metrics.row(0).is_rough_terrain == 0
    metrics.add_scan([0.75])
    metrics.add_imu((5.0, 0.0, 0.0), STILL)
    metrics.add_pose(STILL)
    metrics.add_pose((1.5, 0.0, 0.0))
    row = metrics.row(0)
    assert (row.total_collisions, row.is_rough_terrain, row.distance_traveled) == (1, 1, 1.5)
