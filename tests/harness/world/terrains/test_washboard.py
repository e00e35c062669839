import numpy as np
import pytest

from harness.world.world import build_world


def test_the_ripples_have_their_wavelength_along_x() -> None:
    heights = build_world("washboard", 0).ground.heights
    power = (np.abs(np.fft.rfft(heights[:150], axis=1)) ** 2).mean(axis=0)
    frequency = np.fft.rfftfreq(heights.shape[1], 0.05)
    mean = (power * frequency).sum() / power.sum()
    assert 1.0 / mean == pytest.approx(0.5, rel=0.05)


def test_the_ripples_are_two_amplitudes_high() -> None:
    heights = build_world("washboard", 0).ground.heights
    crest, trough = np.percentile(heights[:, -100:], (97, 3))
    assert crest - trough == pytest.approx(2 * 0.025, rel=0.25)
