"""What a fit came to: its estimates, and how far ours was from the recording and is."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.base.errors import UsageError
from harness.base.workers import Show, Workers
from harness.fit.estimate import Estimate, fitted
from harness.fit.ground import UNITS, differences, ground
from harness.fit.motors import motors
from harness.fit.mount import mount
from harness.fit.response import difference, response
from harness.fit.steady import Steady, kinds, steady
from harness.robots import RoverSpec
from harness.validate.real.commanded import step_ends
from harness.validate.recordings.recording import Recording, at, in_order

HELD_BACK = 1 / 3  # of the steps, the last ones
STEP = 6.0  # [s] of what is judged as a step where the recording names none
FEWEST = 3  # steps that are held back
LEAD = 0.5  # [s] before the first of these that ours drives

Pair = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Outcome:
    """A fit.

    Attributes:
        rover, fitted: Before and after.
        estimates: All that was sought.
        recording: What was fitted to.
        like, ours: Kinds of steady driving, and ours beside them, before and after.
        residuals: Root mean squares of ours less the recorded, before and after, by quantity and unit.
        held: Shares of their lengths by which held-back steps ended elsewhere, before and after.
    """

    rover: RoverSpec
    fitted: RoverSpec
    estimates: tuple[Estimate, ...]
    recording: Recording
    like: Steady
    ours: tuple[Steady, Steady]
    residuals: Mapping[tuple[str, str], Pair]
    held: tuple[np.ndarray, np.ndarray]


def fit(rover: RoverSpec, whole: Recording, workers: Workers, show: Show) -> Outcome:
    """Fits a rover to a recording.

    Args:
        rover: With real actuators, where the search begins.
        whole: From `reading.read`; its last steps are held back.
        workers: Drive.
        show: Called with how many are done, and of how many.

    Raises:
        UsageError: The recording tells nothing.
    """
    recording, held = split(whole)
    first = response(rover, recording)
    constants = [*motors(rover, whole), *mount(rover, whole)]
    near = fitted(rover, [*first, *constants])
    some = steady(_drawn(recording, near))
    like = kinds(some)
    found, before, after = ground(near, some, like, workers, show)
    loaded = fitted(near, found)
    second = response(rover, recording, loaded)
    estimates = (*second, *found, *constants)
    if not any(one.is_known for one in estimates):
        reasons = "; ".join(dict.fromkeys(one.why for one in estimates))
        raise UsageError(f"{whole.name} tells nothing: {reasons}")
    best = fitted(loaded, second)
    was, now = (_rms(difference(one, recording)) for one in (rover, best))
    pairs = {("speed of the sides", "m/s"): (was, now)}
    off, left = (differences(ours, like) for ours in (before, after))
    for name, unit in UNITS.items():
        if np.isfinite(left[name]).any():
            pairs[name.replace("_", " "), unit] = _rms(off[name]), _rms(left[name])
    ends = [step_ends(one, held) if held is not None else np.empty(0) for one in (rover, best)]
    beside = like, (before, after)
    return Outcome(rover, best, estimates, recording, *beside, pairs, (ends[0], ends[1]))


def split(whole: Recording) -> tuple[Recording, Recording | None]:
    """Returns what is fitted to, and the last steps, held back; None without poses or steps."""
    if "poses" not in whole.series:
        return whole, None
    steps = whole.steps
    if not len(steps):
        begins = np.arange(0.0, whole.wheels[-1, 0] - STEP, STEP)
        steps = np.column_stack([begins, begins + STEP])
    count = round(HELD_BACK * len(steps))
    if count < FEWEST:
        return whole, None
    begin, stepped = float(steps[-count, 0]), replace(whole, steps=steps)
    lead = np.array([begin - LEAD])
    in_force = np.column_stack([lead, at(whole.commands, lead)])  # a log may have changes alone
    held = stepped.within(begin - LEAD, np.inf)
    commands = in_order(np.concatenate([in_force, held.commands]))
    return stepped.within(-np.inf, begin), replace(held, commands=commands)


def _drawn(recording: Recording, rover: RoverSpec) -> Recording:
    """A recording whose currents are, where it has none, those of its torques."""
    if "currents" in recording.series or "torques" not in recording.series:
        return recording
    assert rover.actuators is not None  # noqa: S101 - the command checks it
    return replace(recording, currents=recording.torques / [1.0, *2 * [rover.actuators.motor_constant]])


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean(values**2))) if np.isfinite(values).any() else float("nan")
