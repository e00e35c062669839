from dataclasses import astuple, dataclass

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.world.heightfield import Field
from harness.world.terrain import Terrain, constant, parameter
from harness.world.terrains.ground import Flat


@dataclass(frozen=True, kw_only=True)
class Noise(Terrain):
    name = "noise"
    summary = "white noise"
    promise = Flat.promise

    size: float = constant(12.0, "m")
    height: float = parameter(0.1, 0.5, 2.0, "m")
    stones: int = parameter(1, 4, 9, "")
    rocks: int = parameter(0, 0, 3, "")

    def _heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        return self.height * rng.standard_normal(x.shape) - 0.0


def test_difficulty_moves_parameters_from_easiest_through_default_to_hardest() -> None:
    made = [astuple(Noise.at_difficulty(difficulty)) for difficulty in (0.0, 0.25, 0.5, 0.58, 0.75, 1.0)]
    size, cell, height, stones, rocks = zip(*made, strict=True)
    assert made[2] == astuple(Noise())
    assert {*size, *cell} == {12.0, 0.1}
    assert height == pytest.approx((0.1, 0.3, 0.5, 0.74, 1.25, 2.0))
    assert (stones, rocks) == ((1, 2, 4, 5, 6, 9), (0, 0, 0, 0, 2, 3))  # whole, the nearest
    assert {type(count) for count in (*stones, *rocks)} == {int}
    spread = "size 12 m, cell 0.1 m, height 0.5 (0.1..2) m, stones 4 (1..9), rocks 0 (0..3)"
    assert Noise.describe() == spread


def test_the_spawn_is_levelled_and_the_rest_is_left_alone() -> None:
    heights = Noise().ground(np.random.default_rng(0)).heights
    axis = np.linspace(-6.0, 6.0, 121)
    distance = np.hypot(*np.meshgrid(axis, axis))
    made = 0.5 * np.random.default_rng(0).standard_normal((121, 121))
    assert np.ptp(heights[distance <= 1.0]) == 0.0
    assert heights[60, 60] == pytest.approx(made[distance <= 1.0].mean(), abs=1e-6)
    assert np.allclose(heights[distance >= 4.0], made[distance >= 4.0], atol=1e-6)


def test_heights_are_whole_micrometres_without_negative_zero() -> None:
    heights = Noise(height=1e-6).ground(np.random.default_rng(0)).heights
    assert np.array_equal(heights, np.round(heights, 6))
    assert not np.signbit(heights[heights == 0.0]).any()


@pytest.mark.parametrize("height", [np.nan, np.ones(3), 1.0])
def test_heights_that_are_no_map_are_refused(height: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Noise, "_heights", lambda *_: height)
    with pytest.raises(UsageError, match="121 x 121"):
        Noise().ground(np.random.default_rng(0))
