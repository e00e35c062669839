"""The grounds of the manoeuvres, as functions of the place ahead of the rover."""

import cmath
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.validate.grounds import block, floor, ramp, saddle
from harness.world.obstacles import ObstacleKind

SEEDS = pytest.mark.parametrize("seed", [0, 1, 2])


def test_seeds_change_heading_and_floor_and_the_same_seed_does_not() -> None:
    one, same, other = floor(1), floor(1), floor(2)
    assert one.heading == same.heading != other.heading
    assert np.array_equal(one.world.ground.heights, same.world.ground.heights)
    assert not np.array_equal(one.world.ground.heights, other.world.ground.heights)
    headings = [floor(seed).heading for seed in range(30)]
    assert min(headings) < -2.0
    assert 2.0 < max(headings) < math.pi
    assert len({saddle(seed, 1.0).world.ground.height_at(0.2, 0.2) > 0.0 for seed in range(8)}) == 2


@SEEDS
def test_a_floor_is_even_a_ramp_bends_up_and_a_saddle_lifts_the_diagonal_wheels(seed: int) -> None:
    ground = floor(seed).world.ground
    assert ground.heights.std() == pytest.approx(0.0005)
    course, along = ramp(seed, math.radians(30.0)), np.linspace(-3.0, 5.0, 801)
    slope = math.tan(math.radians(30.0)) * np.clip((along - 0.6) / 0.8, 0.0, 1.0)
    profile = np.concatenate([[0.0], np.cumsum((slope[1:] + slope[:-1]) / 2 * np.diff(along))])
    for aside in (-1.5, 1.5):
        places = (complex(x, aside) * cmath.exp(1j * course.heading) for x in along.tolist())
        heights = [course.world.ground.height_at(place.real, place.imag) for place in places]
        assert heights == pytest.approx(profile, abs=0.004)
    twisted = saddle(seed, 1.0)
    corners = [
        (x, y, twisted.world.ground.height_at(0.2 * x, 0.2 * y)) for x in (-1, 1) for y in (-1, 1)
    ]
    lifted = 0.04 * math.exp(-0.04)  # z = x y, less where it flattens
    assert [x * y * z / corners[-1][2] for x, y, z in corners] == pytest.approx([1.0] * 4)
    assert abs(corners[0][2]) == pytest.approx(lifted)
    assert abs(math.degrees(twisted.heading)) <= 3.0


@SEEDS
def test_a_block_stands_ahead_and_aside_in_line_with_the_rover(seed: int) -> None:
    course = floor(seed, block("box", (0.2, 0.3, 0.05), x=2.0, y=0.5))
    (stone,) = course.world.obstacles
    place = complex(2.0, 0.5) * cmath.exp(1j * course.heading)
    assert stone.position == pytest.approx((place.real, place.imag, 0.05))
    assert (stone.half_size, stone.kind) == ((0.2, 0.3, 0.05), ObstacleKind.ROCK)
    turn = Rotation.from_quat(stone.quaternion, scalar_first=True).as_rotvec()
    assert turn == pytest.approx((0.0, 0.0, course.heading))
