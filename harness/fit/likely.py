"""Whether the series of a recording can be of one rover: their sizes and signs beside its wheels'."""

from dataclasses import replace

import numpy as np

from harness.base.errors import UsageError
from harness.robots import RoverSpec
from harness.validate.recordings.recording import Recording, Series, at, empty

TICK, WINDOW = 0.05, 20  # [s]; ticks, of a second, over which motions are compared
MOST = 4.0  # times the wheels' motion, and its inverse: less is slip, or a driver's limit
MOVES = 0.1  # [m], [rad] rms in a window that says something
LIKE = 0.3  # least correlation of what tells of the same motion
LIMITED = 20.0  # times the wheels' motion that a rover's limit may explain; degrees are 57 times radians
ALIKE = 0.7  # least correlation of commands with wheels that follow them up to a limit
PROPORTIONAL, VARIED = 0.97, 0.25  # correlation of what is in other units; least variation of speeds
LATEST = 30  # ticks that wheels may be late by


def likely(recording: Recording, rover: RoverSpec) -> Recording:
    """Returns a recording without what cannot be of it, which its problems then say.

    That are poses that do not go with the wheels, and the power of a battery that is charged.

    Args:
        recording: Has commands and wheels on one clock.
        rover: That drove.

    Raises:
        UsageError: Commands are of another size than the wheels, as in other units, or do not go
            with them; or the wheels alone do not go with the others.
    """
    there = [recording.commands, recording.wheels, *([recording.poses] if len(recording.poses) else [])]
    begin, end = max(v[0, 0] for v in there), min(v[-1, 0] for v in there)
    times = np.arange(begin, end, TICK)
    left, right = at(recording.wheels, times).T
    ahead, turned = _moved((left + right) / 2), _moved((right - left) / rover.controller_separation)
    v, w = at(recording.commands, times).T
    problems = _unlike_commands(recording, "commanded speed", "m/s", v, ahead)
    problems += _unlike_commands(recording, "commanded yaw rate", "rad/s", w, turned)
    if len(recording.power) and (mean := float(recording.power[:, 1].mean())) < 0.0:
        reason = f"the battery gives {mean:.0f} W on average, as if its currents had another sign"
        problems += (f"{recording.name}: {reason} (negative: it discharges); the power is left out",)
        recording = _without(recording, "power")
    if len(recording.poses):
        x, y, yaw = (values[WINDOW:] - values[:-WINDOW] for values in at(recording.poses, times).T)
        straight = np.abs(turned) < MOVES  # poses may be of a place beside the middle
        reasons = (
            _unlike("the poses' yaw rate", "rad/s", yaw, turned, 1),
            _unlike("the poses' speed", "m/s", np.hypot(x, y)[straight], np.abs(ahead[straight]), 0),
        )
        if reason := next(filter(None, reasons), ""):
            if _likeness(_moved(w), yaw, LATEST) > max(ALIKE, _likeness(turned, yaw, LATEST)):
                raise _refused(recording, "wheels turn otherwise than commands and poses, as if swapped")
            problems += (f"{recording.name}: {reason}; the poses are left out",)
            recording = _without(recording, "poses")
    return replace(recording, problems=recording.problems + problems)


def _without(recording: Recording, name: str) -> Recording:
    sources = {one: topic for one, topic in recording.sources.items() if one != name}
    nothing = empty(recording.series[name].shape[1])
    return replace(recording, sources=sources, **{name: nothing})  # type: ignore[arg-type]  # of a series


def _moved(rates: Series) -> Series:
    """What a rate comes to within each window."""
    total = np.concatenate([[0.0], np.cumsum(rates[:-1] * TICK)])
    windows: Series = total[WINDOW:] - total[:-WINDOW]
    return windows


def _unlike_commands(
    recording: Recording, what: str, unit: str, rates: Series, wheels: Series
) -> tuple[str, ...]:
    """Checks commands; returns a line where a limit of the rover explains that they are larger."""
    theirs, speeds = _moved(rates), np.abs(rates[rates != 0.0])
    reason = _unlike(what, unit, theirs, wheels, LATEST)
    if not reason:
        return ()
    is_larger = _size(wheels) < _size(theirs) < LIMITED * _size(wheels)
    likeness = _likeness(theirs, wheels, LATEST)
    # A limit lets faster commands go no faster; of other units, they go as much faster.
    is_scaled = likeness > PROPORTIONAL and speeds.std() > VARIED * speeds.mean()
    if is_larger and likeness > ALIKE and not is_scaled:
        return (f"{recording.name}: {reason}; that is taken for a limit of the rover",)
    raise _refused(recording, reason)


def _refused(recording: Recording, reason: str) -> UsageError:
    columns = "give sides and units in the columns' names, as left_wheel [rad/s]"
    mend = "--topic chooses another topic" if recording.sources else columns
    return UsageError(f"{recording.name}: {reason}; {mend}")


def _unlike(what: str, unit: str, theirs: Series, wheels: Series, latest: int) -> str:
    """What of a motion differs from the wheels', its size or its course; "" if nothing does."""
    size, rolled = _size(theirs), _size(wheels)
    if max(size, rolled) < MOVES:
        return ""
    if not rolled / MOST < size < rolled * MOST:
        return f"{what} is {size:.2f} {unit}, the wheels' {rolled:.2f} {unit}"
    if _likeness(theirs, wheels, latest) < LIKE:
        return f"{what} and the wheels' do not go together, as if a side or a sign were swapped"
    return ""


def _size(moved: Series) -> float:
    return float(np.sqrt((moved**2).mean())) if len(moved) else 0.0


def _likeness(theirs: Series, wheels: Series, latest: int) -> float:
    """The largest correlation where wheels are fewer ticks late than `latest`; NaN if nothing varies."""
    if not latest or min(theirs.std(), wheels.std()) < MOVES:
        return float("nan")
    pairs = ((theirs[: len(theirs) - late], wheels[late:]) for late in range(0, latest, 5))
    return float(max(np.corrcoef(*pair)[0, 1] for pair in pairs))
