"""Whether the series of a recording can be of one rover: their sizes and signs beside its wheels'."""

import numpy as np

from harness.base.errors import UsageError
from harness.recordings.recording import Recording, Series, at
from harness.robots import RoverSpec

TICK, WINDOW = 0.05, 20  # [s]; ticks over which motions are compared
MOST = 4.0  # times the wheels' motion, and its inverse: less is slip, or a driver's limit
MOVES = 0.1  # [m], [rad] rms in a window that says something
LIKE = 0.3  # least correlation of what tells of the same motion
LATEST = 30  # ticks that wheels may be late by


def check_likely(recording: Recording, rover: RoverSpec) -> None:
    """Checks what commands and poses tell of motion beside what the wheels do.

    Args:
        recording: Has commands and wheels on one clock.
        rover: That drove.

    Raises:
        UsageError: They are of another size, as in other units, or do not go with the wheels.
    """
    there = [recording.commands, recording.wheels, *([recording.poses] if len(recording.poses) else [])]
    begin, end = max(v[0, 0] for v in there), min(v[-1, 0] for v in there)
    times = np.arange(begin, end, TICK)
    left, right = at(recording.wheels, times).T
    ahead, turned = _moved((left + right) / 2), _moved((right - left) / rover.controller_separation)
    v, w = at(recording.commands, times).T
    _check(recording, "cmd_v", _moved(v), ahead, LATEST)
    _check(recording, "cmd_w", _moved(w), turned, LATEST)
    if len(recording.poses):
        x, y, yaw = (values[WINDOW:] - values[:-WINDOW] for values in at(recording.poses, times).T)
        _check(recording, "yaw", yaw, turned, 1)
        straight = np.abs(turned) < MOVES  # poses may be of a place beside the middle
        _check(recording, "x, y", np.hypot(x, y)[straight], np.abs(ahead[straight]), 0)


def _moved(rates: Series) -> Series:
    """What a rate comes to within each window."""
    total = np.concatenate([[0.0], np.cumsum(rates[:-1] * TICK)])
    windows: Series = total[WINDOW:] - total[:-WINDOW]
    return windows


def _check(recording: Recording, what: str, theirs: Series, wheels: Series, latest: int) -> None:
    """Compares sizes, and likeness where the wheels may be fewer ticks late than `latest`."""
    if not len(theirs):
        return
    size, rolled = (float(np.sqrt((values**2).mean())) for values in (theirs, wheels))
    if max(size, rolled) < MOVES:
        return
    if not rolled / MOST < size < rolled * MOST:
        columns = "give units in the columns' names, as left_wheel [rad/s]"
        mend = "--topic chooses another topic" if recording.sources else columns
        raise UsageError(
            f"{recording.name}: {what} are {size:.3g} (m or rad) a second where the wheels' are "
            f"{rolled:.3g}; {mend}"
        )
    if not latest or min(theirs.std(), wheels.std()) < MOVES:
        return
    pairs = ((theirs[: len(theirs) - late], wheels[late:]) for late in range(0, latest, 5))
    if max(np.corrcoef(*pair)[0, 1] for pair in pairs) < LIKE:
        raise UsageError(
            f"{recording.name}: {what} and wheels do not go together; is a side or a sign swapped?"
        )
