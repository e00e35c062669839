import numpy as np

from harness.world.statistics import slopes
from harness.world.world import build_world

REPOSE = 34.0  # [deg] dry sand


def test_even_the_hardest_dunes_stay_below_the_angle_of_repose() -> None:
    for seed in range(5):
        assert np.percentile(slopes(build_world("dunes", seed, 1.0).ground), 99.9) < REPOSE


def test_lee_sides_are_steeper_than_windward_sides() -> None:
    along_x = np.diff(build_world("dunes", 0).ground.heights, axis=1) / 0.1
    windward, lee = along_x[along_x > 0.02], -along_x[along_x < -0.02]
    assert lee.mean() > 1.4 * windward.mean()
    assert len(windward) > 1.4 * len(lee)
