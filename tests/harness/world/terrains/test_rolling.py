import numpy as np

from harness.world.world import build_world


def test_its_hills_are_metres_wide_and_nothing_is_small() -> None:
    heights = build_world("rolling", 0).ground.heights
    power = (np.abs(np.fft.rfft(heights * np.hanning(heights.shape[1]), axis=1)) ** 2).mean(axis=0)
    frequency = np.fft.rfftfreq(heights.shape[1], 0.1)
    assert power[frequency > 1.0].sum() < 1e-3 * power.sum()


def test_it_has_no_obstacles() -> None:
    assert build_world("rolling", 0).obstacles == ()
