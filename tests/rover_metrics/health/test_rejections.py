import math

import pytest

from rover_metrics.health import rejections as faults

STILL = (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("acceleration", "angular_velocity", "name"),
    [
        ((math.nan, 0.0, 0.0), STILL, faults.NOT_FINITE),
        (STILL, (0.0, math.inf, 0.0), faults.NOT_FINITE),
        ((1e300, 0.0, 0.0), (0.0, 0.0, math.nan), faults.NOT_FINITE),
        ((0.0, 1e300, 0.0), STILL, faults.HUGE_ACCELERATION),
        ((-6e4, -6e4, -6e4), STILL, faults.HUGE_ACCELERATION),
        ((1e308, 1e308, 1e308), STILL, faults.HUGE_ACCELERATION),
        ((100000.1, 0.0, 0.0), (0.0, 0.0, -1e5), faults.HUGE_ACCELERATION),
        ((1e5, 0.0, 0.0), (0.0, 0.0, -1e5), faults.HUGE_ANGULAR_RATE),
    ],
)
def test_a_refused_imu_sample_has_a_reason(
    acceleration: tuple[float, float, float], angular_velocity: tuple[float, float, float], name: str
) -> None:
    assert faults.imu_fault(acceleration, angular_velocity) == name


@pytest.mark.parametrize(
    ("velocity", "name"),
    [
        ((0.0, math.nan, 0.0), faults.NOT_FINITE),
        ((-math.inf, 0.0, 0.0), faults.NOT_FINITE),
        ((1e300, 0.0, 0.0), faults.HUGE_SPEED),
        ((-6e3, -6e3, -6e3), faults.HUGE_SPEED),
        ((1e308, 1e308, 0.0), faults.HUGE_SPEED),
    ],
)
def test_a_refused_velocity_has_a_reason(velocity: tuple[float, float, float], name: str) -> None:
    assert faults.odometry_fault(velocity) == name


@pytest.mark.parametrize(
    ("nearest", "farthest", "limits", "name"),
    [
        (0.2, 9.9, (0.15, 10.0), None),
        (0.15, 10.0, (0.15, 10.0), None),
        (0.0, 9.9, (0.15, 10.0), faults.ZERO_OR_LESS),
        (-1.0, 9.9, (0.0, 0.0), faults.ZERO_OR_LESS),
        (0.1, 9.9, (0.15, 10.0), faults.BELOW_LIMIT),
        (0.2, 10.1, (0.15, 10.0), faults.ABOVE_LIMIT),
        (0.1, 99.0, (0.0, 0.0), None),
        (0.1, 99.0, (5.0, 5.0), None),
        (0.1, 10.1, (0.15, 10.0), faults.BELOW_LIMIT),
        (1e-9, 9.9, (0.0, 10.0), None),
        (0.1, 99.0, (10.0, 0.15), None),
        (0.1, 99.0, (math.nan, math.nan), None),
    ],
)
def test_a_reading_outside_the_limits_is_odd_if_the_limits_are_an_interval(
    nearest: float, farthest: float, limits: tuple[float, float], name: str | None
) -> None:
    assert faults.scan_oddity(nearest, farthest, *limits) == name
