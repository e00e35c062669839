"""How wheels follow commands: dead time, lag, what the driver makes of yaw rates; without physics."""

import numpy as np

from harness.base.sim_time import TICK
from harness.fit.estimate import Estimate, minimise, of, with_values
from harness.robots import RoverSpec
from harness.validate.real.commanded import as_driven
from harness.validate.recordings.recording import Recording, Series, at, between, changes
from harness.validate.replay import controlled, replay

TOLERANCE = 0.03  # [m/s]
SPENT = 0.1  # [m/s] by which load slows a wheel whose motor gives all it has
STEP = 0.02  # [s], [m]: for derivatives, above a tick
FINEST = 0.001  # [s], [m]: what ticks and the physics' own steps leave open whatever the recording
VARIES = 0.1  # least sd of commands for an estimate [m/s], [rad/s]
HELD = 0.4  # [s]: logs repeat a sample no longer
MOST = 0.95  # of the largest difference that is asked for: a limit beyond is none that was met
UNLIMITED = "no command asked for more than came"
ROUNDS = 2  # of a search, each with what load then makes of the speeds
LONGEST = 1.5  # [s] that a command may take to a wheel
LIMIT = "actuators.turn_limit"
BOUNDS = {
    "actuators.delay": (0.0, 1.0),
    "actuators.lag": (0.0, 1.0),
    "controller_separation": (0.1, 4.0),
    LIMIT: (0.05, 10.0),
}


def response(rover: RoverSpec, recording: Recording, loaded: RoverSpec | None = None) -> list[Estimate]:
    """Returns delay, lag, the separation that the driver believes, the limit of the sides' difference.

    Args:
        rover: With real actuators.
        recording: Has commands and wheels.
        loaded: A rover that is near to it, to take into account what load makes of the speeds of ours;
            None for nothing.
    """
    moves, turns = recording.commands[:, 1:].std(axis=0) > VARIES
    driven = as_driven(rover, recording)
    is_clipped = bool(turns) and driven.actuators != rover.actuators
    still = "" if moves or turns else "changes of the command are missing"
    straight = "" if turns else "turns are missing"
    unlimited = "" if is_clipped else UNLIMITED
    blank = [
        Estimate(name, unit, key, of(rover, key), why=why, scale=scale)
        for name, unit, key, scale, why in (
            ("delay", "s", "actuators.delay", 0.02, still),
            ("lag", "s", "actuators.lag", 0.05, still),
            ("believed separation", "m", "controller_separation", 0.0, straight),
            ("limit of the sides' difference", "m/s", LIMIT, 0.0, unlimited),
        )
    ]
    free = [one.key for one in blank if one.is_known]
    if not free:
        return blank
    low, high = np.array([BOUNDS[key] for key in free]).T
    late = _late(driven, recording) / 2
    near = loaded or with_values(driven, [("actuators.delay", late), ("actuators.lag", late)])
    values = np.array([of(driven if key == LIMIT else near, key) for key in free])
    for _ in range(ROUNDS if loaded else 1):
        lost = _lost(loaded and with_values(loaded, zip(free, values.tolist(), strict=True)), recording)

        def residuals(values: Series, lost: Series | float = lost) -> Series:
            ours = with_values(driven, zip(free, values.tolist(), strict=True))
            obeys = np.abs(lost) < SPENT  # other wheels do what they can, whatever the controller wants
            return np.where(obeys, difference(ours, recording) - lost, 0.0) / TOLERANCE

        values, halves, *_ = minimise(residuals, values, (low, high), np.full(len(free), STEP))
    fits = iter(zip(values.tolist(), np.hypot(halves, FINEST).tolist(), strict=True))
    lack = "changes of the command are too few"
    known = [one.judged(*next(fits), lack) if one.is_known else one for one in blank]
    separation, limit = known[-2], known[-1]
    if limit.after > MOST * separation.after * float(np.abs(recording.commands[:, 2]).max()):
        known[-1] = blank[-1].unknown(UNLIMITED)
    return known


def difference(rover: RoverSpec, recording: Recording) -> Series:
    """Returns ours less the recorded speeds of the sides, where those changed [m/s]."""
    times = _news(recording.wheels)
    return (between(controlled(rover, recording), times) - at(recording.wheels, times)).ravel()


def _lost(rover: RoverSpec | None, recording: Recording) -> Series | float:
    """By how much wheels of ours are slower under load than its controller wants, as `difference`."""
    if rover is None:
        return 0.0
    times = _news(recording.wheels)
    driven = replay(rover, recording.commands, float(recording.wheels[-1, 0]), every=1)
    return (between(controlled(rover, recording), times) - between(driven.wheels, times)).ravel()


def _late(rover: RoverSpec, recording: Recording) -> float:
    """How much later wheels do what is commanded, by the largest correlation [s]."""
    quick = rover.but(real=False)
    ours, wheels = controlled(quick, recording), recording.wheels
    shifts = np.arange(0.0, LONGEST, 2 * TICK)
    squares = [((at(ours, wheels[:, 0] - shift) - wheels[:, 1:]) ** 2).mean() for shift in shifts]
    return float(shifts[int(np.argmin(squares))])


def _news(series: Series) -> Series:
    """Times at which a series says something: it has just changed, or not for as long as logs hold."""
    changed = changes(series[:, 1:])
    latest = np.maximum.accumulate(np.where(changed, series[:, 0], -np.inf))
    chosen = (changed | (series[:, 0] - latest > HELD)) & (series[:, 0] >= 0.0)
    times: Series = series[chosen, 0]
    return times
