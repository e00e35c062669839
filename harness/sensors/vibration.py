"""What tyres and gears shake an IMU by, however even the ground: lines and bands that grow with speed.

Physics has round wheels; lugs and gears are what a real rover's IMU feels most of on hard ground. Each
shake has a standard deviation sd v^power at the wheels' speed v, and sits in a band of frequencies or
follows the lugs, which pass v / spacing times a second. It is made at 100 Hz and averaged over what lies
between two readings, as the IMU averages the rest.
"""

import math
from collections.abc import Sequence

import numpy as np
from scipy.signal import butter, sosfilt

from harness.base.sim_time import NANOSECONDS
from harness.robots.sections import Shake
from harness.samples import Vector3

RATE = 100  # [Hz] at which it is made
MOVING = 0.02  # [m/s]: a rover that is slower stands
ORDER = 2  # of the filters
SETTLED = 200  # samples after which a filter has forgotten that it began at rest
JITTER = 0.1  # [rad] of a lug's phase in a sample: tyres are not exact


class _Band:
    """Noise of a shake's band with a standard deviation of 1."""

    def __init__(self, shake: Shake, rng: np.random.Generator) -> None:
        self._rng = rng
        high = min(shake.high, 0.49 * RATE)
        if shake.low > 0.0:
            self._sos = butter(ORDER, (shake.low, high), "bandpass", fs=RATE, output="sos")
        else:
            self._sos = butter(ORDER, high, "lowpass", fs=RATE, output="sos")
        self._state = np.zeros((len(self._sos), 2))
        impulse = sosfilt(self._sos, np.eye(1, 20 * RATE)[0])
        self._gain = 1.0 / math.sqrt(float((impulse**2).sum()))
        self.draw(SETTLED, 0.0)

    def draw(self, count: int, _: float) -> np.ndarray:
        white = self._rng.normal(size=count)
        shaped, self._state = sosfilt(self._sos, white, zi=self._state)
        return np.asarray(self._gain * shaped)


class _Lugs:
    """The line of lugs that pass, with a standard deviation of 1."""

    def __init__(self, shake: Shake, rng: np.random.Generator) -> None:
        self._rng, self._spacing = rng, shake.spacing
        self._phase = float(rng.uniform(0.0, math.tau))

    def draw(self, count: int, speed: float) -> np.ndarray:
        turns = math.tau * speed / self._spacing / RATE + JITTER * self._rng.normal(size=count)
        phases = self._phase + np.cumsum(turns)
        self._phase = float(phases[-1]) % math.tau
        return np.asarray(math.sqrt(2.0) * np.sin(phases))


class Vibration:
    """Shakes the vertical acceleration of an IMU while the rover moves.

    Args:
        shakes: What shakes it.
        rng: Draws the noise.
    """

    def __init__(self, shakes: Sequence[Shake], rng: np.random.Generator) -> None:
        kinds = [(_Lugs if shake.spacing else _Band)(shake, rng) for shake in shakes]
        self._sources = list(zip(shakes, kinds, strict=True))
        self._stamp_ns: int | None = None

    def shake(self, force: Vector3, speed: float, stamp_ns: int) -> Vector3:
        """Returns a reading with what has shaken it since the last one.

        Args:
            force: Specific force in the IMU's frame [m/s^2].
            speed: By the wheels [m/s].
            stamp_ns: Of the reading.
        """
        elapsed = 0 if self._stamp_ns is None else stamp_ns - self._stamp_ns
        self._stamp_ns = stamp_ns
        count, moving = max(1, round(RATE * elapsed / NANOSECONDS)), abs(speed)
        x, y, z = force
        for shake, source in self._sources:
            drawn = float(source.draw(count, moving).mean())
            z += shake.sd * moving**shake.power * drawn if moving > MOVING else 0.0
        return x, y, z
