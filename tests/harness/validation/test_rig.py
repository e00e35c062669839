import math

import numpy as np
import pytest

from harness.robots import LEO
from harness.validation.grounds import Block, floor, saddle
from harness.validation.rig import Rig, steepest


def test_bisection_finds_the_last_step_that_passes() -> None:
    tried = []

    def passes(height: float) -> bool:
        tried.append(height)
        return height < 0.0721

    assert steepest(passes, 0.03, 0.14, 0.005) == pytest.approx(0.070)
    assert len(tried) <= 5


def test_bisection_tells_apart_nothing_passes_and_everything_does() -> None:
    assert math.isnan(steepest(lambda _: False, 1, 9, 1))
    assert steepest(lambda _: True, 1, 9, 1) == 9


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_rover_drives_ahead_on_whatever_heading_it_was_set_down(seed: int) -> None:
    rig = Rig(LEO, floor(seed))
    rig.command(0.4)
    rig.run(2.0)
    assert rig.stance.ahead == pytest.approx(0.4 * 2.0, abs=0.08)
    assert rig.stance.aside == pytest.approx(0.0, abs=0.02)


def test_seeds_change_heading_and_floor_and_the_same_seed_does_not() -> None:
    one, same, other = floor(1), floor(1), floor(2)
    assert one.heading == same.heading != other.heading
    assert np.array_equal(one.world.ground.heights, same.world.ground.heights)
    assert not np.array_equal(one.world.ground.heights, other.world.ground.heights)


def test_blocks_stand_ahead_of_the_rover_and_are_felt() -> None:
    rig = Rig(LEO, floor(3, Block(shape="cylinder", half_size=(0.1, 0.2), x=0.6)))
    assert not rig.touches_block
    rig.command(0.4)
    assert rig.run_until(lambda: rig.touches_block, 2.0)
    assert rig.stance.ahead + LEO.footprint[1] == pytest.approx(0.5, abs=0.1)


def test_a_saddle_lifts_the_diagonal_wheels_alike() -> None:
    ground = saddle(0, 1.0).world.ground
    corner = abs(ground.height_at(0.15, 0.18))
    assert corner == pytest.approx(0.15 * 0.18, rel=0.15)
    assert ground.height_at(0.15, 0.18) == pytest.approx(ground.height_at(-0.15, -0.18))
    assert ground.height_at(0.15, -0.18) == pytest.approx(-ground.height_at(0.15, 0.18), rel=0.2)
