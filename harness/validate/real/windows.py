"""What two seconds of steady driving tell: vibration, effective track, current."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from harness.validate.recordings.recording import Recording, lag, moved

WINDOW = 2.0  # [s]
LOW_BAND = (1.0, 10.0)  # [Hz]
STEADY = 0.06  # [m/s]: largest difference of the sides while straight on, and 1.2 of the speed's sd
SLOWEST = 0.25  # [m/s]
BINS = (0.25, 0.5, 0.75, math.inf)  # [m/s]
ON_THE_SPOT, TURNING = 0.05, 0.2  # [m/s]: mean of the sides at most, and their difference at least
STRAIGHT_YAW = 0.1  # [rad/s]
FEWEST_IMU, FEWEST_WHEELS = 150, 8  # samples of a window
HELD = 0.5  # of the yaw that hard ground gives, below which a rover is stuck or held
STRAIGHT, SPOT, ARC = "straight", "on the spot", "in an arc"


@dataclass(frozen=True)
class Window:
    """Two seconds of one kind of driving.

    Attributes:
        kind: STRAIGHT, SPOT or ARC.
        speed: Mean of both sides [m/s], without sign.
        difference: Right side's speed less the left's [m/s].
        yaw_rate: Mean [rad/s]; NaN without an IMU.
        sd: Of the vertical acceleration [m/s^2]; NaN without an IMU.
        share: Of its power that lies in LOW_BAND.
        current: Of both sides [A]; NaN where it was not recorded.
    """

    kind: str
    speed: float
    difference: float
    yaw_rate: float
    sd: float
    share: float
    current: float


def aligned(recording: Recording, track: float) -> Recording:
    """Returns a recording whose IMU's clock is that of its wheels, as far as its turns tell."""
    if not (len(recording.wheels) > 1 and len(recording.imu) > 1):
        return recording
    return replace(recording, imu=moved(recording.imu, -(lag(recording, track) or 0.0)))


def windows(recording: Recording) -> Iterator[Window]:
    """Yields the windows of steady driving of a recording."""
    wheels = recording.wheels
    for begin in np.arange(wheels[0, 0], wheels[-1, 0] - WINDOW, WINDOW):
        part = recording.within(begin, begin + WINDOW)
        if len(part.wheels) < FEWEST_WHEELS or (len(recording.imu) and len(part.imu) < FEWEST_IMU):
            continue
        window = _window(part)
        if window is not None:
            yield window


def _window(part: Recording) -> Window | None:
    left, right = part.wheels[:, 1], part.wheels[:, 2]
    mean, difference = (left + right) / 2, right - left
    speed, wide = abs(float(mean.mean())), abs(float(difference.mean()))
    if max(mean.std(), difference.std()) > STEADY:
        return None
    yaw_rate = float(part.imu[:, 3].mean()) if len(part.imu) else np.nan
    if np.abs(difference).max() <= STEADY:
        kind = STRAIGHT
        if speed < SLOWEST or abs(yaw_rate) > STRAIGHT_YAW:
            return None
    elif wide >= TURNING:
        kind = SPOT if speed <= ON_THE_SPOT else ARC
    else:
        return None
    sd, share = _vibration(part.imu) if len(part.imu) else (np.nan, np.nan)
    current = float(part.currents[:, 1:].sum(axis=1).mean()) if len(part.currents) else np.nan
    return Window(kind, speed, float(difference.mean()), yaw_rate, sd, share, current)


def _vibration(imu: np.ndarray) -> tuple[float, float]:
    vertical = imu[:, 6] - imu[:, 6].mean()
    power = np.abs(np.fft.rfft(vertical)) ** 2
    rate = (len(imu) - 1) / (imu[-1, 0] - imu[0, 0])
    frequencies = np.fft.rfftfreq(len(vertical), 1 / rate)
    low = (frequencies >= LOW_BAND[0]) & (frequencies <= LOW_BAND[1])
    return float(vertical.std()), float(power[low].sum() / max(power[1:].sum(), 1e-12))


def effective_track(some: Iterable[Window], track: float) -> float:
    """Returns the sides' difference over the yaw rate [m], by least squares; NaN of too few windows.

    Those in which the rover is held do not count; `track` is that on hard ground [m].
    """
    pairs = [
        (one.difference, one.yaw_rate)
        for one in some
        if one.yaw_rate * one.difference > HELD * one.difference**2 / track
    ]
    if len(pairs) < 2:
        return float("nan")
    difference, rate = np.array(pairs).T
    return float(difference @ difference / (difference @ rate))
