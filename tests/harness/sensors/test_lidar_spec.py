import math

import numpy as np
import pytest

from harness.errors import UsageError
from harness.sensors.lidar_spec import LidarSpec


def test_the_defaults_are_those_of_roboterrains_gpu_lidar() -> None:
    assert LidarSpec() == LidarSpec(beams=640, range_min=0.15, range_max=10.0, angle_max=3.14159)


@pytest.mark.parametrize(("beams", "angle_max"), [(2, 1.0), (5, 0.5), (640, 3.14159)])
def test_beams_lie_evenly_from_right_to_left_with_both_ends(beams: int, angle_max: float) -> None:
    angles = LidarSpec(beams=beams, angle_max=angle_max).angles
    assert angles.shape == (beams,)
    assert (angles[0], angles[-1]) == (-angle_max, angle_max)
    np.testing.assert_allclose(np.diff(angles), 2 * angle_max / (beams - 1))


@pytest.mark.parametrize("beams", [1, 0, -5])
def test_a_lidar_without_a_fan_is_refused(beams: int) -> None:
    with pytest.raises(UsageError, match=f"^a lidar needs 2 beams or more, not {beams}$"):
        LidarSpec(beams=beams)


@pytest.mark.parametrize(
    ("nearest", "farthest", "told"),
    [
        (3.0, 2.0, "range_min 3 m, range_max 2 m"),
        (2.0, 2.0, "range_min 2 m, range_max 2 m"),
        (-0.1, 2.0, "range_min -0.1 m"),
        (0.1, math.inf, "range_max inf m"),
        (math.nan, 2.0, "range_min nan m"),
        (0.1, math.nan, "range_max nan m"),
    ],
)
def test_limits_that_are_no_range_are_refused(nearest: float, farthest: float, told: str) -> None:
    with pytest.raises(UsageError, match=f"{told}.*: not a range$"):
        LidarSpec(range_min=nearest, range_max=farthest)
    assert LidarSpec(range_min=0.0).range_min == 0.0


@pytest.mark.parametrize("beams", [4, 5, 640])
def test_the_first_beam_looks_ahead_as_the_lidar_looks_backwards(beams: int) -> None:
    bearings = LidarSpec(beams=beams).bearings
    angles = np.linspace(-3.14159, 3.14159, beams)
    expected = np.angle(np.exp(1j * (angles + math.pi)))
    assert np.exp(1j * bearings) == pytest.approx(np.exp(1j * expected))
    assert np.abs(bearings).max() <= math.pi
    assert bearings[0] == pytest.approx(0.0, abs=1e-5)
