import array
import csv
import io
import math

import numpy as np
import pytest

from rover_metrics.metrics import WINDOW, TraversalMetrics
from rover_metrics.row import COLUMNS, MetricsRow
from rover_metrics.thresholds import Thresholds

STILL = (0.0, 0.0, 0.0)
INF = math.inf
NAN = math.nan


@pytest.fixture
def metrics() -> TraversalMetrics:
    return TraversalMetrics()


def csv_line(row: MetricsRow) -> str:
    text = io.StringIO(newline="")
    csv.writer(text).writerow(row.as_fields())
    return text.getvalue()


# The row


def test_the_row_before_any_sample_is_the_seeds_to_the_byte(metrics: TraversalMetrics) -> None:
    expected = "1737047098,0,0,0.0,0,inf,0.0,0,0,0,0,Normal operation\r\n"
    assert csv_line(metrics.row(1737047098)) == expected


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


def test_floats_are_rounded_to_four_decimals_and_counts_stay_integers() -> None:
    row = MetricsRow(3, 4, 1, 1.00005, 2.123449, 1 / 3, 0.0, 10.0, 1e16, 0, 9.8, "note, with comma")
    assert csv_line(row) == ('3,4,1,1.0001,2.1234,0.3333,0.0,10.0,1e+16,0,9.8,"note, with comma"\r\n')


def test_a_mean_of_zero_is_a_float_where_an_empty_window_is_an_integer(
    metrics: TraversalMetrics,
) -> None:
    metrics.add_odometry(STILL)
    metrics.add_imu(STILL, STILL)
    assert csv_line(metrics.row(0)) == "0,0,0,0.0,0.0,inf,0.0,0.0,0.0,0,0.0,Normal operation\r\n"


def test_a_row_has_as_many_cells_as_there_are_columns(metrics: TraversalMetrics) -> None:
    assert len(metrics.row(0).as_fields()) == len(COLUMNS) == 12


# Scans


def test_clearance_is_the_minimum_of_the_finite_ranges(metrics: TraversalMetrics) -> None:
    assert metrics.add_scan([NAN, -INF, 2.5, INF, 1.5])
    assert metrics.clearance == 1.5
    assert metrics.total_collisions == 0


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


def test_a_zero_range_counts_as_a_collision(metrics: TraversalMetrics) -> None:
    metrics.add_scan([0.0, 5.0])
    assert metrics.total_collisions == 1
    assert metrics.clearance == 0.0


def test_collisions_count_per_scan_not_per_event_and_never_forget(
    metrics: TraversalMetrics,
) -> None:
    for _ in range(3 * WINDOW):
        metrics.add_scan([0.1, 0.05])
    assert metrics.row(0).total_collisions == 3 * WINDOW


def test_collision_status_looks_at_the_window_mean(metrics: TraversalMetrics) -> None:
    metrics.add_scan([0.125])
    assert metrics.row(0).collision_status == 1
    metrics.add_scan([0.5])
    assert metrics.row(0).collision_status == 0
    assert metrics.total_collisions == 1


def test_collision_status_is_strictly_below_the_threshold() -> None:
    metrics = TraversalMetrics(Thresholds(collision_threshold=0.25))
    metrics.add_scan([0.25])
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
    expected = np.mean(scans[-WINDOW:].min(axis=1).astype(np.float64))
    assert metrics.row(1).obstacle_clearance == pytest.approx(expected, abs=1e-12)


def test_ranges_count_as_the_float32_that_a_message_would_carry(
    metrics: TraversalMetrics,
) -> None:
    metrics.add_scan([1 / 3])
    assert metrics.clearance == float(np.float32(1 / 3)) != 1 / 3


def test_a_scan_is_only_read(metrics: TraversalMetrics) -> None:
    scan = np.array([1.0, INF, 0.5], dtype=np.float32)
    scan.setflags(write=False)
    assert metrics.add_scan(scan)


# IMU


def test_smoothness_adds_acceleration_and_angular_velocity(metrics: TraversalMetrics) -> None:
    metrics.add_imu((0.0, 0.0, 9.8), STILL)
    metrics.add_imu((2.0, 3.0, 6.0), (2.0, 4.0, 4.0))  # 7 + 6
    row = metrics.row(0)
    assert row.smoothness_metric == pytest.approx(22.8)
    assert row.current_smoothness == pytest.approx(11.4)
    assert row.imu_acceleration_magnitude == 7.0


def test_rough_terrain_is_strictly_above_the_threshold(metrics: TraversalMetrics) -> None:
    metrics.add_imu((9.0, 12.0, 0.0), STILL)
    assert metrics.row(0).is_rough_terrain == 0
    metrics.add_imu((9.0, 12.0, 0.01), STILL)
    assert metrics.row(0).is_rough_terrain == 1


def test_rough_terrain_is_about_the_latest_sample_only(metrics: TraversalMetrics) -> None:
    metrics.add_imu((99.0, 0.0, 0.0), STILL)
    metrics.add_imu((1.0, 0.0, 0.0), STILL)
    assert metrics.row(0).is_rough_terrain == 0
    assert metrics.row(0).imu_acceleration_magnitude == 1.0


def test_vertical_roughness_is_the_absolute_z_acceleration(metrics: TraversalMetrics) -> None:
    metrics.add_imu((5.0, 5.0, -9.8), STILL)
    assert metrics.row(0).vertical_roughness == 9.8


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


def test_the_first_pose_is_no_travel(metrics: TraversalMetrics) -> None:
    assert metrics.add_pose((0.1, 0.1, 0.1))
    assert metrics.total_distance == 0.0


def test_distance_is_three_dimensional(metrics: TraversalMetrics) -> None:
    metrics.add_pose(STILL)
    metrics.add_pose((0.02, 0.03, 0.06))
    assert metrics.total_distance == pytest.approx(0.07)


@pytest.mark.parametrize(("step", "counted"), [(0.4999, True), (0.5, False), (3.0, False)])
def test_a_step_counts_strictly_below_the_distance_threshold(
    metrics: TraversalMetrics, step: float, counted: bool
) -> None:
    metrics.add_pose(STILL)
    metrics.add_pose((step, 0.0, 0.0))
    assert metrics.total_distance == (step if counted else 0.0)
    assert metrics.last_step == step


def test_after_a_jump_the_next_step_starts_where_it_ended(metrics: TraversalMetrics) -> None:
    metrics.add_pose(STILL)
    metrics.add_pose((10.0, 0.0, 0.0))
    metrics.add_pose((10.25, 0.0, 0.0))
    assert metrics.total_distance == 0.25


@pytest.mark.parametrize("bad", [(NAN, 0.0, 0.0), (0.0, INF, 0.0), (0.0, 0.0, -INF)])
def test_a_pose_that_is_not_finite_is_left_out(
    metrics: TraversalMetrics, bad: tuple[float, float, float]
) -> None:
    metrics.add_pose(STILL)
    assert not metrics.add_pose(bad)
    metrics.add_pose((0.25, 0.0, 0.0))
    assert metrics.total_distance == 0.25


# Odometry


def test_velocity_is_the_mean_of_magnitudes_so_reverse_is_no_different(
    metrics: TraversalMetrics,
) -> None:
    metrics.add_odometry((1.0, 0.0, 0.0))
    metrics.add_odometry((-1.0, 2.0, 2.0))
    assert metrics.row(0).current_velocity == 2.0


def test_velocity_over_rough_is_recorded_while_the_latest_imu_sample_is_rough(
    metrics: TraversalMetrics,
) -> None:
    metrics.add_odometry((1.0, 0.0, 0.0))
    assert metrics.velocity_over_rough == 0.0
    metrics.add_imu((16.0, 0.0, 0.0), STILL)
    metrics.add_odometry((0.5, 0.0, 0.0))
    metrics.add_imu((9.8, 0.0, 0.0), STILL)
    metrics.add_odometry((0.75, 0.0, 0.0))
    assert metrics.velocity_over_rough == 0.5


@pytest.mark.parametrize("bad", [(NAN, 0.0, 0.0), (0.0, INF, 0.0), (0.0, 0.0, -INF)])
def test_odometry_that_is_not_finite_is_left_out(
    metrics: TraversalMetrics, bad: tuple[float, float, float]
) -> None:
    assert not metrics.add_odometry(bad)
    assert metrics.row(0).current_velocity == 0


# Windows and thresholds


def test_windows_hold_exactly_the_last_hundred_samples(metrics: TraversalMetrics) -> None:
    for value in [1000.0] + [1.0] * 99:
        metrics.add_scan([value])
        metrics.add_imu((value, 0.0, 0.0), STILL)
        metrics.add_odometry((value, 0.0, 0.0))
    full = metrics.row(0)
    assert (full.obstacle_clearance, full.current_smoothness, full.current_velocity) == (
        10.99,
        10.99,
        10.99,
    )
    metrics.add_scan([1.0])
    metrics.add_imu((1.0, 0.0, 0.0), STILL)
    metrics.add_odometry((1.0, 0.0, 0.0))
    slid = metrics.row(0)
    assert (slid.obstacle_clearance, slid.current_smoothness, slid.current_velocity) == (1, 1, 1)
    assert slid.smoothness_metric == 1100.0


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
