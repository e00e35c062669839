"""What the ground does: friction, turning and rolling resistance, drag, and the wheels' true radius.

Closed forms tell the effective track and where the search begins. The search drives the rover steadily,
as the recorded one was driven, and compares yaw rate, speed and currents.
"""

from collections.abc import Sequence
from dataclasses import fields, replace
from functools import partial

import numpy as np

from harness.base.workers import Show, Workers, work_off
from harness.fit.estimate import Estimate, Minimum, minimise, of, slope, with_values
from harness.fit.steady import LENGTH, SETTLED, Steady, window
from harness.robots import RoverSpec
from harness.robots.model import compiled_alone
from harness.validate.grounds import flat
from harness.validate.recordings.recording import Series
from harness.validate.replay import replay

TOLERANCES = {"yaw_rate": 0.03, "ahead": 0.04}
CURRENTS = "left_current", "right_current"
UNSTEADY = 10.0  # tolerances by which ours is off where it does not drive steadily
SHARE = 0.1  # of a current, and of their median: their tolerance
UNITS = {"yaw_rate": "rad/s", "ahead": "m/s", "left_current": "A", "right_current": "A"}
BOUNDS = {"tyres.radius": (0.8, 1.25), "tyres.friction": (0.05, 2.0), "tyres.turning": (0.0, 0.5),
          "tyres.rolling": (0.0, 0.6), "tyres.drag": (0.0, 0.6)}  # of the radius factors  # fmt: skip
STEPS = {"tyres.radius": 0.03, "tyres.friction": 0.05, "tyres.turning": 0.01, "tyres.rolling": 0.01,
         "tyres.drag": 0.02}  # for derivatives: contacts are rough  # fmt: skip
DRAGS = 0.2, 0.7  # shares of what resists straight on that a search begins with as drag
ALIKE = 1.05  # times the least cost: what also explains the recording
# Half a size and cells as those of terrains [m], across which it is driven [rad]: their edges resist.
PLANE = 20.0, 0.1, 0.5
SETTLING, MEASURED = 0.7, 1.3  # [s] of ours, whose commands act at once
LIGHT = 0.02  # [m], or of a load: less does not matter
VAGUE_KINDS = "steady driving of more kinds is missing"
NEVER_HELD = f"one command held for {SETTLED + LENGTH:g} s is missing"


def track(some: Steady, ours: Steady) -> Estimate:
    """Returns the effective track, the sides' difference over the yaw rate: as recorded, and ours."""
    blank = Estimate("effective track", "m", "", _track(ours)[0])
    value, half = _track(some)
    if not some.left.size:
        return blank.unknown(NEVER_HELD)
    if not np.isfinite(value):
        lack = "turns" if np.isfinite(some.yaw_rate).any() or not some.turns.any() else "poses or an IMU"
        return blank.unknown(f"{lack} are missing")
    return blank.judged(value, half, "turns are too few")


def _track(some: Steady) -> tuple[float, float]:
    known = some.turns & np.isfinite(some.yaw_rate)
    rate, half = slope(some.difference[known], some.yaw_rate[known])
    return 1.0 / rate if rate else np.nan, half / rate**2 if rate else np.inf


def blanks(rover: RoverSpec, some: Steady) -> tuple[list[Estimate], list[Estimate], list[Estimate]]:
    """Returns what can be sought, what acts but is not driven so that it shows, and what has no data."""
    nothing = {
        "poses are missing": not np.isfinite(some.ahead).any(),
        "currents or torques are missing": not np.isfinite(some.left_current).any(),
        "poses or an IMU are missing": not np.isfinite(some.yaw_rate).any(),
    }
    poses, forces, yaws = nothing
    on, arcs = "driving straight on is missing", some.turns & some.drives
    table = (
        ("wheel radius", "m", "tyres.radius", poses, some.is_straight, on),
        ("friction", "", "tyres.friction", forces, some.spots, "turns on the spot are missing"),
        ("turning friction", "m", "tyres.turning", yaws, some.turns, "turns are missing"),
        ("rolling resistance", "", "tyres.rolling", forces, some.is_straight, on),
        ("drag", "", "tyres.drag", poses, arcs, "arcs are missing"),
    )
    free, hidden, unknown = list[Estimate](), list[Estimate](), list[Estimate]()
    for name, unit, key, lack, windows, missing in table:
        scale = 0.0 if key in ("tyres.radius", "tyres.friction") else LIGHT
        one = Estimate(name, unit, key, of(rover, key), scale=scale)
        if not some.left.size or nothing[lack]:
            unknown.append(one.unknown(lack if some.left.size else NEVER_HELD))
        elif windows.sum() > 1:
            free.append(one)
        else:
            hidden.append(one.unknown(missing))
    return free, hidden, unknown


def ground(
    rover: RoverSpec, some: Steady, like: Steady, workers: Workers, show: Show
) -> tuple[tuple[Estimate, ...], Steady, Steady]:
    """Returns what the ground does, and ours beside the kinds of steady driving, before and after.

    Args:
        rover: With real actuators, where the search begins.
        some: Recorded windows of steady driving.
        like: Their kinds, as which ours is driven.
        workers: Do so, from several starts at once.
        show: Called with how many are done, and of how many.
    """
    free, hidden, unknown = blanks(rover, some)
    before = driven(rover, like)
    search = partial(_search, rover, some=some, like=like, workers=workers, show=show)
    # What no driving shows acts all the same: without it, others would seem to be known better.
    among = search([*free, *hidden]) if free and hidden else []
    together: list[Estimate] = []
    while free:
        found = search(free)
        together = together or found
        estimates = [_as_wide(one, _named(one.key, together)) for one in found]
        vague = [one for one in estimates if not one.is_known]
        if not vague:
            break
        # The others again, for they were found together with what is not written.
        free = [one for one, sought in zip(free, estimates, strict=True) if sought.is_known]
        unknown += vague
    known = [one.widened(_named(one.key, among or together)) for one in estimates] if free else []
    unknown = [*hidden, *unknown]
    after = driven(with_values(rover, [(one.key, one.after) for one in known]), like)
    return (track(some, before), *known, *unknown), before, after


def _search(
    rover: RoverSpec, free: Sequence[Estimate], some: Steady, like: Steady, workers: Workers, show: Show
) -> list[Estimate]:
    """What is free, with the values that explain the recorded windows best, however vague."""
    keys, prior = [one.key for one in free], np.array([one.before for one in free])
    starts = [np.array([_begun(rover, some, share)[key] for key in keys]) for share in DRAGS]
    solutions: dict[int, Minimum] = {}

    def keep(number: int, outcome: Minimum) -> None:
        solutions[number] = outcome
        show(len(solutions), len(starts))

    sought = partial(_sought, rover, like, tuple(keys), prior)
    work_off(
        dict(enumerate(starts)), sought, workers, keep,
        name=lambda number: f"search {number}", mend="give fewer --jobs",
    )  # fmt: skip
    best = min(solutions.values(), key=lambda one: one.cost)
    others = [one.point for one in solutions.values() if one.cost <= ALIKE * best.cost + 1e-3]
    halves = np.maximum(best.halves, np.ptp(others, axis=0))
    found = zip(best.point.tolist(), halves.tolist(), best.rough.tolist(), strict=True)
    return [
        replace(one, after=value, half=half, rough=rough)
        for one, (value, half, rough) in zip(free, found, strict=True)
    ]


def _named(key: str, estimates: Sequence[Estimate]) -> Estimate:
    return next(one for one in estimates if one.key == key)


def _as_wide(alone: Estimate, together: Estimate) -> Estimate:
    """What was found without what is too vague, no more certain than what was found together with it."""
    half = max(alone.half, together.half, abs(alone.after - together.after))
    return alone.judged(alone.after, half, VAGUE_KINDS)


def _sought(
    rover: RoverSpec, like: Steady, keys: Sequence[str], prior: Series, start: Series
) -> Minimum:
    is_radius = np.array(keys) == "tyres.radius"
    low, high = np.array([BOUNDS[key] for key in keys]).T * np.where(is_radius, prior, 1.0)
    steps = np.array([STEPS[key] for key in keys]) * np.where(is_radius, prior, 1.0)

    def residuals(values: Series) -> Series:
        ours = driven(with_values(rover, zip(keys, values.tolist(), strict=True)), like)
        return np.concatenate(list(compared(ours, like).values()))

    return minimise(residuals, start, (low, high), steps)


def compared(ours: Steady, like: Steady) -> dict[str, Series]:
    """Returns ours less the recorded over their tolerances, by quantity, weighted."""
    weight = np.sqrt(like.weight / like.weight.mean())
    residuals = {}
    for name, off in differences(ours, like).items():
        known, wide = np.isfinite(getattr(like, name)), np.full(off.size, TOLERANCES.get(name, 0.0))
        if name in CURRENTS:
            real: Series = getattr(like, name)
            wide = SHARE * np.maximum(real, _middle(like.left_current + like.right_current) / 2)
        scaled = np.where(np.isfinite(off), off / wide, UNSTEADY)
        residuals[name] = (weight * scaled)[known]
    return residuals


def differences(ours: Steady, like: Steady) -> dict[str, Series]:
    """Returns ours less the recorded, by quantity; NaN of what either does not have."""
    errors = {name: getattr(ours, name) - getattr(like, name) for name in UNITS}
    known = np.isfinite(errors["ahead"])
    off, turning = errors["ahead"][known], like.yaw_rate[known]
    # Poses may be to the side of the rover's middle.
    aside = float(off @ turning) / max(float(turning @ turning), 1e-9)
    errors["ahead"][known] -= aside * turning
    return errors


def driven(rover: RoverSpec, like: Steady) -> Steady:
    """Returns our windows of steady driving, each as one of a recording; NaN where ours is not steady.

    A speed loop lets the wheels lag behind under load: ours are scaled to the recorded wheels' speeds.
    """
    assert rover.actuators is not None  # noqa: S101 - the command checks it
    if not like.left.size:
        return like
    plain = rover.actuators.but(delay=0.0, lag=0.0, turn_limit=None, dead_band=0.0)
    rover, span = rover.but(actuators=plain), SETTLING + MEASURED
    begins = span * np.arange(like.left.size)
    rates = like.difference / rover.controller_separation
    commands, plane = np.column_stack([begins, like.mean, rates]), flat(*PLANE)
    recorded = replay(rover, commands, span * begins.size, course=plane)
    rows = [window(recorded, begin + SETTLING, begin + span) for begin in begins]
    nothing = (np.nan,) * len(fields(Steady))
    ours = Steady(*np.array([nothing if row is None else row for row in rows]).T)
    return replace(
        ours,
        yaw_rate=ours.yaw_rate * np.where(like.turns, like.difference / ours.difference, 1.0),
        ahead=ours.ahead * np.where(like.drives, like.mean / ours.mean, 1.0),
    )


def _begun(rover: RoverSpec, some: Steady, share: float) -> dict[str, float]:
    """Where a search begins: by closed forms of four equal contacts with dry friction.

    Straight on the motors' torque is (rolling + drag) W r; on the spot that of a side is besides
    friction W/2 r L / sqrt(L^2 + B^2), for the contacts slide along (L, B).

    Args:
        rover: Whose motor constant, weight and size are taken.
        some: Recorded windows.
        share: Of the resistance straight on that is drag.
    """
    assert rover.actuators is not None  # noqa: S101 - the command checks it
    straight, spots = some.is_straight, some.spots
    model, _ = compiled_alone(rover)
    torque = rover.actuators.motor_constant / rover.wheel_radius
    load = float(model.body_mass.sum()) * rover.gravity / torque  # as a current
    drawn = some.left_current + some.right_current
    resistance = _middle(drawn[straight]) / load
    along = rover.wheelbase / np.hypot(rover.wheelbase, rover.track)
    friction = (_middle(drawn[spots]) / load - resistance * (1.0 - share)) / along
    known = straight & np.isfinite(some.ahead)
    ratio, _ = slope(some.mean[known], some.ahead[known])
    hard, turned = rover.track + rover.wheelbase**2 / rover.track, _track(some)[0]
    begun = {
        "tyres.radius": rover.wheel_radius * ratio, "tyres.friction": max(friction, 0.1),
        "tyres.turning": 0.3 * max(turned - hard, 0.0), "tyres.rolling": resistance * (1.0 - share),
        "tyres.drag": resistance * share,
    }  # fmt: skip
    return {key: value if np.isfinite(value) else of(rover, key) for key, value in begun.items()}


def _middle(values: Series) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else np.nan
