from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from harness.world.heightfield import Heightfield, fractal, smoothstep
from harness.world.world import World, build_world
from tests.support.terrain_statistics import residual_rms

TopAt = Callable[[float, float], float]


@pytest.mark.parametrize("name", ["flat", "slope", "gravel", "rocky", "washboard", "marsyard"])
def test_height_at_agrees_with_mujoco_between_the_vertices(
    name: str, ground_top: Callable[[World], TopAt]
) -> None:
    world = build_world(name, 3)
    rectangle = Heightfield(world.ground.heights[60:, 20:-13], world.ground.cell)
    world = replace(world, ground=rectangle)
    top_at, reach = ground_top(world), np.array(world.ground.half_size) - 0.01
    points = np.random.default_rng(0).uniform(-reach, reach, (300, 2))
    ours = [world.ground.height_at(x, y) for x, y in points]
    theirs = [top_at(x, y) for x, y in points]
    assert ours == pytest.approx(theirs, abs=1e-5)


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


def _fractal(seed: int = 0, shortest: float = 0.5) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return fractal(rng, (201, 201), cell=0.1, longest=4.0, shortest=shortest)


def test_fractal_noise_has_zero_mean_and_unit_rms() -> None:
    assert _fractal().mean() == pytest.approx(0.0, abs=1e-12)
    assert _fractal().std() == pytest.approx(1.0)


def test_fractal_noise_depends_on_nothing_but_its_generator() -> None:
    assert np.array_equal(_fractal(5), _fractal(5))
    assert not np.array_equal(_fractal(5), _fractal(6))


def test_fractal_noise_gets_rougher_with_shorter_wavelengths() -> None:
    rough, smooth = (residual_rms(Heightfield(_fractal(shortest=s), cell=0.1), 0.3) for s in (0.2, 1.0))
    assert rough > 2.0 * smooth


def test_fractal_noise_does_not_prefer_an_axis() -> None:
    along_y, along_x = np.gradient(_fractal())
    assert along_y.std() == pytest.approx(along_x.std(), rel=0.15)


def test_fractal_noise_does_not_repeat_at_the_edges() -> None:
    noise = _fractal()
    assert abs(np.corrcoef(noise[0], noise[-1])[0, 1]) < 0.6


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
