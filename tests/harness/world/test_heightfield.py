from collections.abc import Callable

import numpy as np
import pytest

from harness.world.heightfield import Heightfield, fractal, smoothstep
from harness.world.world import World

TopAt = Callable[[float, float], float]


def test_height_at_agrees_with_mujoco_between_the_vertices(ground_top: Callable[[World], TopAt]) -> None:
    rng = np.random.default_rng(0)
    ground = Heightfield(rng.normal(0.0, 0.2, (41, 67)), 0.1)
    top_at, reach = ground_top(World("w", ground, (), 0, 0.5)), np.array(ground.half_size) - 0.01
    points = rng.uniform(-reach, reach, (1000, 2))
    assert ground.heights_at(*points.T) == pytest.approx([top_at(x, y) for x, y in points], abs=1e-5)


def test_rows_run_with_y_and_columns_with_x(ground_top: Callable[[World], TopAt]) -> None:
    heights = np.zeros((5, 5))
    heights[4, 1] = 1.0
    world = World("spike", Heightfield(heights, cell=1.0), (), 0, 0.5)
    assert world.ground.height_at(-1.0, 2.0) == 1.0
    assert ground_top(world)(-1.0, 2.0 - 1e-6) == pytest.approx(1.0, abs=1e-4)


def test_points_beyond_the_map_have_the_height_of_its_edge() -> None:
    ground = Heightfield(np.arange(12.0).reshape(3, 4), cell=0.5)
    assert ground.half_size == (0.75, 0.5)
    assert ground.height_at(99.0, 99.0) == 11.0
    assert ground.height_at(0.75, -99.0) == 3.0
    assert ground.height_at(-99.0, -99.0) == 0.0


def test_a_single_point_has_the_height_that_it_has_among_many_to_the_bit() -> None:
    rng = np.random.default_rng(2)
    ground = Heightfield(rng.normal(size=(9, 13)), cell=0.3, middle=(1.7, -0.4))
    inside_and_out = rng.uniform(-1.3, 1.3, (500, 2)) * ground.half_size
    vertices = np.stack(np.meshgrid(np.arange(-7, 8), np.arange(-5, 6)), axis=-1).reshape(-1, 2) * 0.3
    x, y = (np.vstack([inside_and_out, vertices]) + ground.middle).T
    assert [ground.height_at(*at) for at in zip(x, y, strict=True)] == ground.heights_at(x, y).tolist()


def test_fractal_noise_has_the_power_law_that_its_wavelengths_and_exponent_tell() -> None:
    """Seamless, its spectrum is that of white noise times a law; its RMS is 1 in any case."""
    made = {"cell": 0.2, "longest": 4.0, "shortest": 0.5, "hurst": 0.7}
    noise = fractal(np.random.default_rng(5), (96, 96), **made, seamless=True)
    white = np.random.default_rng(5).standard_normal((96, 96))
    per_metre = np.hypot(np.fft.fftfreq(96, 0.2)[:, None], np.fft.fftfreq(96, 0.2))
    law = (per_metre**2 + 4.0**-2) ** -1.7 * np.exp(-((per_metre * 0.5) ** 2))  # of its power
    power = np.abs(np.fft.fft2(noise) / np.fft.fft2(white)) ** 2
    np.testing.assert_allclose(
        (power / power[0, 1]).ravel()[1:], (law / law[0, 1]).ravel()[1:], rtol=1e-6
    )
    part = fractal(np.random.default_rng(5), (77, 77), **made)  # type: ignore[arg-type]
    for field in (noise, part):
        assert (field.mean(), field.std()) == pytest.approx((0.0, 1.0))
    assert abs(np.corrcoef(part[0], part[-1])[0, 1]) < 0.6  # it does not repeat at its edges


@pytest.mark.parametrize("count", [150, 151])
def test_seamless_noise_goes_on_from_each_edge_at_the_opposite_one(count: int) -> None:
    rng = np.random.default_rng(0)
    noise = fractal(rng, (count, count), cell=0.1, longest=4.0, shortest=1.0, seamless=True)
    assert noise.shape == (count, count)
    for axis in (0, 1):
        steps = np.diff(noise, axis=axis)
        seam = noise.take(0, axis) - noise.take(-1, axis)
        assert seam.std() == pytest.approx(steps.std(), rel=0.4)


def test_smoothstep_rises_from_zero_to_one_without_kinks() -> None:
    steps = smoothstep(np.linspace(0.0, 4.0, 401), 1.0, 3.0)
    assert (steps[:101] == 0.0).all()
    assert (steps[300:] == 1.0).all()
    assert steps[200] == pytest.approx(0.5)
    assert np.diff(steps, 2).max() < 2e-4
