"""What shakes an IMU, by its spectrum: bands as wide as asked for, lugs as often as they pass."""

import numpy as np
import pytest

from harness.robots.sections import Shake
from harness.sensors.vibration import MOVING, RATE, Vibration

COUNT, TICK_NS = 4000, 10_000_000
LUGS, BAND = Shake(sd=0.8, power=1.5, spacing=0.05), Shake(sd=0.8, power=0.5, low=10.0, high=20.0)


@pytest.mark.parametrize("speed", [0.4, -0.9])
@pytest.mark.parametrize("shake", [LUGS, BAND], ids=["lugs", "band"])
def test_a_shake_has_the_strength_and_the_frequencies_that_it_is_given(
    shake: Shake, speed: float
) -> None:
    vibration = Vibration([shake], np.random.default_rng(1))
    readings = [vibration.shake((0.3, 0.2, 9.8), speed, n * TICK_NS) for n in range(COUNT)]
    x, y, z = np.transpose(readings)
    assert (set(x), set(y)) == ({0.3}, {0.2})
    assert z.std() == pytest.approx(shake.sd * abs(speed) ** shake.power, rel=0.1)
    power, frequencies = np.abs(np.fft.rfft(z - z.mean())) ** 2, np.fft.rfftfreq(COUNT, 1 / RATE)
    low, high = (shake.low, shake.high) if not shake.spacing else 2 * (abs(speed) / shake.spacing,)
    inside = power[(frequencies > low - 1.0) & (frequencies < high + 1.0)].sum()
    assert inside > 0.8 * power.sum()
    assert vibration.shake((0.0, 0.0, 9.8), 0.9 * MOVING, COUNT * TICK_NS) == (0.0, 0.0, 9.8)
