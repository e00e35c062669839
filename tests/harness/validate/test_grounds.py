"""The grounds of the manoeuvres, as functions of the place ahead of the rover."""

import cmath
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.validate.grounds import Course, block, floor, ramp, saddle
from harness.world.obstacles import ObstacleKind

SEEDS = pytest.mark.parametrize("seed", [0, 1, 2])


def height(course: Course, ahead: float, aside: float) -> float:
    """Of the ground at a place seen from the rover [m]; the turn is that of complex numbers."""
    place = complex(ahead, aside) * cmath.exp(1j * course.heading)
    return course.world.ground.height_at(place.real, place.imag)


def test_seeds_change_heading_and_floor_and_the_same_seed_does_not() -> None:
    one, same, other = floor(1), floor(1), floor(2)

    assert one.heading == same.heading != other.heading
    assert np.array_equal(one.world.ground.heights, same.world.ground.heights)
    assert not np.array_equal(one.world.ground.heights, other.world.ground.heights)
    headings = [floor(seed).heading for seed in range(30)]
    assert min(headings) < -2.0
    assert 2.0 < max(headings) < math.pi


@SEEDS
def test_a_floor_is_as_even_as_good_concrete(seed: int) -> None:
    ground = floor(seed).world.ground

    assert ground.heights.std() == pytest.approx(0.0005)
    assert ground.half_size == pytest.approx((6.0, 6.0))
    assert ground.cell == 0.1


@SEEDS
def test_a_ramp_begins_ahead_bends_and_goes_on_straight(seed: int) -> None:
    incline = math.radians(30.0)
    course = ramp(seed, incline)

    along = np.linspace(-3.0, 5.0, 801)
    slope = math.tan(incline) * np.clip((along - 0.6) / 0.8, 0.0, 1.0)
    profile = np.concatenate([[0.0], np.cumsum((slope[1:] + slope[:-1]) / 2 * np.diff(along))])
    for aside in (-1.5, 0.0, 1.5):
        ours = [height(course, x, aside) for x in along]
        assert ours == pytest.approx(profile.tolist(), abs=0.004)


@SEEDS
def test_a_saddle_lifts_the_diagonal_wheels_alike(seed: int) -> None:
    ground = saddle(seed, 1.0).world.ground
    heights = {(x, y): ground.height_at(0.2 * x, 0.2 * y) for x in (-1, 1) for y in (-1, 1)}

    sign = math.copysign(1.0, heights[1, 1])
    # z = x y about the origin, less where it flattens.
    expected = 0.04 * math.exp(-0.04)
    assert {place: sign * z for place, z in heights.items()} == pytest.approx(
        {(x, y): x * y * expected for x, y in heights}, abs=1e-9
    )
    assert abs(math.degrees(saddle(seed, 1.0).heading)) <= 3.0
    assert ground.height_at(5.0, 5.0) == pytest.approx(0.0, abs=1e-6)


def test_saddles_turn_both_ways() -> None:
    assert len({saddle(seed, 1.0).world.ground.height_at(0.2, 0.2) > 0.0 for seed in range(8)}) == 2


@SEEDS
def test_a_block_stands_ahead_and_aside_in_line_with_the_rover(seed: int) -> None:
    course = floor(seed, block("box", (0.2, 0.3, 0.05), x=2.0, y=0.5))
    (stone,) = course.world.obstacles

    place = complex(2.0, 0.5) * cmath.exp(1j * course.heading)
    assert stone.position == pytest.approx((place.real, place.imag, 0.05))
    assert stone.half_size == (0.2, 0.3, 0.05)
    assert stone.kind is ObstacleKind.ROCK
    turn = Rotation.from_quat(stone.quaternion, scalar_first=True).as_rotvec()
    assert turn == pytest.approx((0.0, 0.0, course.heading))
