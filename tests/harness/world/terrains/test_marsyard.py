import numpy as np
import pytest

from harness.world.terrains.marsyard import Marsyard, crater, hill
from harness.world.world import build_world


def test_it_has_the_relief_and_the_grid_of_the_real_yards_and_is_that_of_the_first_release() -> None:
    for seed, rms in ((0, 0.542478), (3, 0.565457)):
        ground = build_world("marsyard", seed).ground
        heights, plain = ground.heights, np.median(ground.heights)
        assert heights.std() == pytest.approx(rms, abs=2e-6)
        assert 4.5 < np.ptp(heights) < 6.6
        assert 47.0 <= 2 * min(ground.half_size) <= 50.0
        assert ground.cell == 0.1
        assert heights.min() < plain - 0.9  # craters
        assert heights.max() > plain + 2.5  # hills


def test_a_hill_stands_between_two_half_as_high_and_craters_as_deep_as_wide() -> None:
    scales = sorted(
        scale for scale, _ in Marsyard(hill=3.0, crater=1.0)._features(np.random.default_rng(0))
    )
    assert scales == pytest.approx([0.44, 0.72, 1.0, 1.5, 1.5, 3.0])


def test_a_hill_peaks_at_its_centre_and_ends_at_its_radius() -> None:
    assert hill(np.array([0.0, 2.0, 9.0]), 2.0).tolist() == [1.0, 0.0, 0.0]


def test_a_crater_has_a_floor_a_rim_and_an_end() -> None:
    profile = crater(np.array([0.0, 1.0, 2.0, 4.0, 9.0]), 2.0)
    assert profile.tolist() == pytest.approx([-1.0, -1.0, 0.25, 0.0, 0.0])
