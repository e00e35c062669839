import numpy as np
import pytest

from harness.world.statistics import slopes
from harness.world.world import build_world


@pytest.mark.parametrize(("difficulty", "incline"), [(0.0, 2.0), (0.5, 10.0), (1.0, 22.0)])
def test_a_slope_rises_along_x_from_edge_to_edge(difficulty: float, incline: float) -> None:
    ground = build_world("slope", 0, difficulty).ground
    rise = ground.height_at(20.0, 0.0) - ground.height_at(-20.0, 0.0)
    assert np.degrees(np.arctan2(rise, 40.0)) == pytest.approx(incline, abs=0.03)
    assert ground.height_at(0.0, 20.0) == pytest.approx(ground.height_at(0.0, -20.0), abs=0.02)


def test_rolling_hills_are_metres_wide_and_nothing_is_small() -> None:
    heights = build_world("rolling", 0).ground.heights
    power = (np.abs(np.fft.rfft(heights * np.hanning(heights.shape[1]), axis=1)) ** 2).mean(axis=0)
    frequency = np.fft.rfftfreq(heights.shape[1], 0.1)
    assert power[frequency > 1.0].sum() < 1e-3 * power.sum()


@pytest.mark.parametrize(("difficulty", "roughness"), [(0.0, 0.003), (0.5, 0.010), (1.0, 0.020)])
def test_neighbouring_cells_of_gravel_differ_independently_by_its_roughness(
    difficulty: float, roughness: float
) -> None:
    ground = build_world("gravel", 0, difficulty).ground
    steps = np.diff(ground.heights[:200], axis=1)
    assert ground.cell == 0.05
    assert steps.std() / np.sqrt(2.0) == pytest.approx(roughness, rel=0.05)


REPOSE = 34.0  # [deg] dry sand


def test_even_the_hardest_dunes_stay_below_the_angle_of_repose() -> None:
    for seed in range(2):
        assert np.percentile(slopes(build_world("dunes", seed, 1.0).ground), 99.9) < REPOSE


def test_lee_sides_are_steeper_than_windward_sides() -> None:
    along_x = np.diff(build_world("dunes", 0).ground.heights, axis=1) / 0.1
    windward, lee = along_x[along_x > 0.02], -along_x[along_x < -0.02]
    assert lee.mean() > 1.4 * windward.mean()
    assert len(windward) > 1.4 * len(lee)


def test_the_ripples_have_their_wavelength_along_x_and_are_two_amplitudes_high() -> None:
    heights = build_world("washboard", 0).ground.heights
    power = (np.abs(np.fft.rfft(heights[:150], axis=1)) ** 2).mean(axis=0)
    frequency = np.fft.rfftfreq(heights.shape[1], 0.05)
    mean = (power * frequency).sum() / power.sum()
    assert 1.0 / mean == pytest.approx(0.5, rel=0.05)
    crest, trough = np.percentile(heights[:, -100:], (97, 3))
    assert crest - trough == pytest.approx(2 * 0.025, rel=0.25)
