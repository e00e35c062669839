"""What holds for the metrics whatever the sensors say."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from rover_metrics.metrics import (
    LARGEST_ACCELERATION,
    LARGEST_ANGULAR_RATE,
    LARGEST_SPEED,
    WINDOW,
    TraversalMetrics,
)

ANY_FLOAT = st.floats(width=64) | st.sampled_from([math.nan, math.inf, -math.inf, 1e308, -1e308])
ANY_VECTOR = st.tuples(ANY_FLOAT, ANY_FLOAT, ANY_FLOAT)
ANY_RANGES = st.lists(
    st.floats(width=32) | st.sampled_from([math.nan, math.inf, -math.inf, 0.0, -1.0]), max_size=8
)
SAMPLES = st.one_of(
    st.tuples(st.just("scan"), ANY_RANGES),
    st.tuples(st.just("imu"), st.tuples(ANY_VECTOR, ANY_VECTOR)),
    st.tuples(st.just("pose"), ANY_VECTOR),
    st.tuples(st.just("odometry"), ANY_VECTOR),
)


def give(metrics: TraversalMetrics, kind: str, value: object) -> bool:
    if kind == "scan":
        return metrics.add_scan(np.array(value, dtype=np.float32))
    if kind == "imu":
        return metrics.add_imu(*value)  # type: ignore[misc]
    if kind == "pose":
        return metrics.add_pose(value)  # type: ignore[arg-type]
    return metrics.add_odometry(value)  # type: ignore[arg-type]


@settings(max_examples=200)
@given(st.lists(SAMPLES, max_size=40))
def test_sums_stay_finite_and_never_fall(samples: list[tuple[str, object]]) -> None:
    metrics = TraversalMetrics()
    before = metrics.row(0)
    for kind, value in samples:
        usable = give(metrics, kind, value)
        row = metrics.row(0)
        if not usable:
            assert row == before
        for cell in row.as_fields()[:-1]:
            assert not math.isnan(float(cell))
        finite = (row.smoothness_metric, row.current_smoothness, row.distance_traveled)
        assert all(map(math.isfinite, (*finite, row.current_velocity, row.vertical_roughness)))
        assert row.total_collisions >= before.total_collisions
        assert row.smoothness_metric >= before.smoothness_metric
        assert row.distance_traveled >= before.distance_traveled
        before = row


@settings(max_examples=30)
@given(st.lists(SAMPLES, max_size=20), st.integers(1, 40))
def test_windows_never_hold_more_than_they_may(samples: list[tuple[str, object]], repeats: int) -> None:
    metrics = TraversalMetrics()
    for kind, value in samples * repeats:
        give(metrics, kind, value)
    windows = (metrics._clearances, metrics._imu, metrics._velocities)
    assert all(len(window) <= WINDOW for window in windows)


@given(st.floats(0.0, 427.0), st.floats(0.0, 70.0))
def test_what_real_sensors_can_say_is_taken(acceleration: float, rate: float) -> None:
    assert TraversalMetrics().add_imu((0.0, 0.0, acceleration), (rate, 0.0, 0.0))


def test_the_largest_values_are_taken_and_what_is_beyond_them_is_not() -> None:
    for factor, taken in ((1.0, True), (1.001, False)):
        metrics = TraversalMetrics()
        assert metrics.add_imu((factor * LARGEST_ACCELERATION, 0.0, 0.0), (0.0,) * 3) is taken
        assert metrics.add_imu((0.0,) * 3, (0.0, factor * LARGEST_ANGULAR_RATE, 0.0)) is taken
        assert metrics.add_odometry((0.0, 0.0, factor * LARGEST_SPEED)) is taken


def test_a_huge_sample_does_not_swallow_the_sum_of_the_others() -> None:
    metrics = TraversalMetrics()
    metrics.add_imu((1e300, 0.0, 0.0), (0.0, 0.0, 0.0))
    for _ in range(1000):
        metrics.add_imu((0.0, 0.0, 9.8), (0.0, 0.0, 0.0))
    assert math.isclose(metrics.smoothness_metric, 9800.0)


@given(ANY_RANGES)
def test_nearest_and_farthest_are_those_of_the_finite_ranges(ranges: list[float]) -> None:
    metrics = TraversalMetrics()
    finite = [value for value in ranges if math.isfinite(value)]
    assert metrics.add_scan(np.array(ranges, dtype=np.float32)) is bool(finite)
    if finite:
        assert metrics.clearance == min(finite)
        assert metrics.farthest == max(finite)
