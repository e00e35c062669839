"""What recordings with commands tell: how wheels answer a step, and where commanded steps end."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from harness.robots import RoverSpec
from harness.robots.sections import Span
from harness.validate.check import Check, around, at_most
from harness.validate.recordings.recording import Recording, Series, at, changes, moved
from harness.validate.replay import replay

LEVELS = (0.10, 0.63, 0.90)  # of the way from one steady speed to the next
LARGE = 0.15  # [m/s]: smaller changes of a wheel's speed drown in its resolution
TAIL = 2.0  # [s] after a change of the command, in which the wheels settle
LATE = 0.06  # [s]: limit of response times, half the period of a log
END = 0.15  # of the step's length
SHORTEST = 1.0  # [m]: of a shorter step, an end's error counts as a share of this
AROUND = 0.3  # [s] of poses that are averaged
CLIPPED = 98.0  # [percentile] of the sides' differences: their limit, where commands ask for more


def response_times(recording: Recording) -> Series:
    """Returns the medians of the times to LEVELS of the steps of each wheel [s]; NaN without any."""
    commands = recording.commands
    times = commands[changes(commands[:, 1:]), 0][1:]
    times_to = [
        row
        for begin, after in zip(times, np.append(times[1:], recording.wheels[-1, 0]), strict=False)
        if after - begin >= TAIL
        for side in (1, 2)
        if (row := _times(recording.wheels, begin, side)) is not None
    ]
    medians: Series = np.median(times_to, axis=0) if times_to else np.full(len(LEVELS), np.nan)
    return medians


def _times(wheels: Series, begin: float, side: int) -> list[float] | None:
    part = wheels[(wheels[:, 0] >= begin) & (wheels[:, 0] < begin + TAIL)]
    if len(part) < 5:
        return None
    before = at(wheels, np.array([begin]))[0, side - 1]
    after = float(np.median(part[part[:, 0] > begin + TAIL / 2][:, side]))
    if abs(after - before) < LARGE:
        return None
    way = (part[:, side] - before) / (after - before)
    return [float(part[int(np.argmax(way >= level)), 0] - begin) for level in LEVELS]


def as_driven(rover: RoverSpec, recording: Recording) -> RoverSpec:
    """Returns a rover whose driver maps yaw rates to the sides as the recorded one's does."""
    times = recording.wheels[:, 0]
    commanded, sides = at(recording.commands, times), recording.wheels[:, 1:]
    difference, rate = sides[:, 1] - sides[:, 0], commanded[:, 1]
    limit = float(np.percentile(np.abs(difference), CLIPPED))
    free = (np.abs(difference) < 0.9 * limit) & (np.abs(rate) > 0.1) & (np.abs(difference) > 0.02)
    if rover.actuators is None or np.count_nonzero(free) < 50:
        return rover
    separation = float(np.median(difference[free] / rate[free]))
    asked = separation * float(np.percentile(np.abs(rate), CLIPPED))
    turn_limit = limit if asked > 1.1 * limit else rover.actuators.turn_limit
    actuators = rover.actuators.but(turn_limit=turn_limit)
    return rover.but(controller_separation=separation, actuators=actuators)


def response_checks(rover: RoverSpec, recording: Recording) -> Iterator[Check]:
    """Yields the wheels' times to LEVELS of a step."""
    real = response_times(recording)
    if not np.isfinite(real).all():
        return
    ours = response_times(_replayed(as_driven(rover, recording), recording))
    for level, theirs, measured in zip(LEVELS, real, ours, strict=True):
        span = around(float(theirs), LATE, f"{recording.name}; +-{LATE:g} s")
        name = f"{recording.name}: wheels at {level:.0%} of a step after"
        yield Check(name, "s", span, float(measured), digits=2)


def step_ends(rover: RoverSpec, recording: Recording) -> Series:
    """Returns of each step the error of our end over its length, both seen from its begin.

    Where on the rover the recorded poses are is not known: the place that fits all steps best is taken.
    """
    ours = moved(_replayed(rover, recording).poses, recording.commands[0, 0])
    latest = min(recording.poses[-1, 0], ours[-1, 0])
    steps = [step for step in recording.steps if step[1] <= latest]
    if not steps:
        return np.empty(0)
    off = np.array([_displacement(recording.poses, *s) - _displacement(ours, *s) for s in steps])
    turned = np.array([_turned(ours, *step) for step in steps])
    lengths = [max(_length(recording.poses, *step), SHORTEST) for step in steps]
    errors: Series = np.linalg.norm(off - pose_mount(off, turned), axis=1) / lengths
    return errors


def _replayed(rover: RoverSpec, recording: Recording) -> Recording:
    """What a rover of ours does under recorded commands, whose first is at 0 s, until all have acted.

    The last command holds until the wheels', and the steps', end: logs may have changes alone.
    """
    begin = recording.commands[0, 0]
    ends = recording.commands[-1:, 0], recording.wheels[-1:, 0], recording.steps[-1:, 1] + AROUND
    return replay(rover, moved(recording.commands, -begin), float(np.concatenate(ends).max() - begin))


def _turned(poses: Series, begin: float, end: float) -> float:
    return float(np.diff(np.interp([begin, end], poses[:, 0], poses[:, 3]))[0])


def pose_mount(off: Series, turned: Series) -> Series:
    """Returns how much of differences of ways comes from where on the rover the poses are.

    Args:
        off: Of each way, in the rover's axes at its begin [m], shape (n, 2).
        turned: The rover's turn on each [rad], shape (n,).
    """
    c, s = np.cos(turned) - 1.0, np.sin(turned)
    swung = np.stack([np.column_stack([c, -s]), np.column_stack([s, c])], axis=1)
    place = np.linalg.lstsq(swung.reshape(-1, 2), off.ravel(), rcond=None)[0]
    explained: Series = swung @ place
    return explained


def _displacement(poses: Series, begin: float, end: float) -> Series:
    """The end's x and y, seen from the begin [m]; places are means, for those of scan matching jump."""
    places = []
    for time in (begin, end):
        near = poses[np.abs(poses[:, 0] - time) <= AROUND]
        chosen = near if len(near) else poses[[int(np.argmin(np.abs(poses[:, 0] - time)))]]
        places.append(np.median(chosen[:, 1:], axis=0))
    (x, y, yaw), (x_end, y_end, _) = places
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([c * (x_end - x) + s * (y_end - y), c * (y_end - y) - s * (x_end - x)])


def _length(poses: Series, begin: float, end: float) -> float:
    """The way from second to second, or nearly so that it reaches the end [m]."""
    times = np.linspace(begin, end, max(1, round(end - begin)) + 1)
    ways = [_displacement(poses, a, b) for a, b in pairwise(times)]
    return float(sum(np.linalg.norm(way) for way in ways))


def step_checks(rover: RoverSpec, recording: Recording) -> Iterator[Check]:
    """Yields how near to the real ends the commanded steps of ours end."""
    if not len(recording.steps):
        return
    errors = step_ends(as_driven(rover, recording), recording)
    if not len(errors):
        return
    source = f"{recording.name}, {len(errors)} steps"
    quantity = f"{recording.name}: median error of a step's end / its length"
    yield Check(quantity, "", at_most(END, source), float(np.median(errors)))
    quantity, within = f"{recording.name}: steps that end within {END:.0%}", np.mean(errors <= END)
    yield Check(quantity, "", Span(1.0, 1.0, source), float(within), digits=2)
