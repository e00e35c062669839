"""What holds for the metrics whatever the sensors say."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.core.rotation import Vector3

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


@settings(max_examples=60)
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


@pytest.mark.parametrize("component", range(3))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_largest_values_are_taken_and_what_is_beyond_them_is_not(
    component: int, sign: float
) -> None:
    def vector(value: float) -> Vector3:
        x, y, z = (sign * value * (axis == component) for axis in range(3))
        return x, y, z

    metrics, still = TraversalMetrics(), (0.0, 0.0, 0.0)
    for acceleration, rate, speed, taken in ((1e5, 1e4, 1e4, True), (100000.1, 10000.1, 10000.1, False)):
        assert metrics.add_imu(vector(acceleration), still) is taken
        assert metrics.add_imu(still, vector(rate)) is taken
        assert metrics.add_odometry(vector(speed)) is taken
