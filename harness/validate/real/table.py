"""The table: each measure of the real rover with its limits, and ours beside it."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from harness.base.errors import UsageError
from harness.robots import REAL, RoverSpec, equipped
from harness.robots.sections import OPEN, Span
from harness.validate.check import Check
from harness.validate.real.commanded import response_checks, step_checks
from harness.validate.real.windows import (
    ARC,
    BINS,
    SPOT,
    STRAIGHT,
    TURNING,
    Window,
    aligned,
    effective_track,
    windows,
)
from harness.validate.recordings.recording import Recording
from harness.validate.replay import replay

LN_SD, SHARE, TRACK, CURRENT = 0.3, 0.15, 0.10, 0.20  # limits
FEWEST = 4  # windows
STEADY_TIME, SETTLING = 14.0, 2.0  # [s] of ours, and of that before the first window counts

Windows = Sequence[Window]


def compare(
    rover: RoverSpec, recordings: Sequence[Recording], seed: int = 0
) -> tuple[list[Check], list[str]]:
    """Returns the checks of a rover against recordings of a real one, and what was left out and why.

    Args:
        rover: As its folder says; it has sections `actuators` and `surfaces`.
        recordings: Of the real one.
        seed: Of what shakes the IMU.

    Raises:
        UsageError: Nothing can be compared.
    """
    if rover.actuators is None:
        raise UsageError(
            f"{rover.folder / 'rover.yaml'}: key 'actuators' is missing, without which nothing is known "
            "of currents and lags (docs/real_rovers.md); give it"
        )
    steady = [one for one in recordings if len(one.wheels) > 1 and not len(one.commands)]
    unknown = [one for one in steady if not _surface(rover, one.ground)]
    notes = [f"{one.name}: ground '{one.ground}' is no surface of {rover.name}" for one in unknown]
    checks = [*_steady(rover, steady, seed, notes), *_commanded(rover, recordings)]
    if not checks:
        raise UsageError("; ".join(["nothing in these recordings can be compared", *notes[:3]]))
    return checks, notes


def _steady(
    rover: RoverSpec, recordings: Sequence[Recording], seed: int, notes: list[str]
) -> Iterator[Check]:
    """Checks of steady driving, ground by ground; adds to the notes which constant was fitted."""
    track = rover.track + rover.wheelbase**2 / rover.track  # of four contacts with dry friction
    ours: dict[str, Windows] = {}
    theirs: dict[str, Windows] = {}
    for surface in rover.surfaces:
        some = [one for one in recordings if _surface(rover, one.ground) == surface]
        real = [window for one in some for window in windows(aligned(one, track))]
        on_it = equipped(rover, REAL, surface)
        for name, measured in _groups(real).items():
            key = f"{surface}, {name}"
            theirs[key], ours[key] = measured, _driven(on_it, measured, seed)
    constant = _constant(theirs, ours)
    if math.isfinite(constant):
        notes.append(f"currents of ours are times {constant:.2f}, which is fitted to theirs")
    for key, measured in theirs.items():
        yield from _compared(key, measured, ours[key], track, constant)


def _commanded(rover: RoverSpec, recordings: Sequence[Recording]) -> Iterator[Check]:
    """Checks of recordings with commands."""
    for one in recordings:
        if len(one.commands) and len(one.wheels):
            on_it = equipped(rover, REAL, _surface(rover, one.ground))
            yield from response_checks(on_it, one)
            if len(one.poses):
                yield from step_checks(on_it, one)


def _surface(rover: RoverSpec, ground: str) -> str:
    """The surface that a recording's ground names, the longest that does; "" for none."""
    spelled = ground.casefold().replace("-", "_").replace(" ", "_")
    return max((name for name in rover.surfaces if f"_{name}_" in f"_{spelled}_"), key=len, default="")


def _groups(real: Windows) -> dict[str, Windows]:
    """Windows of one kind and one range of speeds that are enough to compare."""
    groups: dict[str, Windows] = {}
    for low, high in pairwise(BINS):
        alike = [one for one in real if one.kind == STRAIGHT and low <= one.speed < high]
        if alike:
            middle = float(np.median([one.speed for one in alike]))
            groups[f"straight at {middle:.2f} m/s"] = alike
    for kind in (SPOT, ARC):
        groups[kind] = [one for one in real if one.kind == kind]
    return {name: some for name, some in groups.items() if len(some) >= FEWEST}


def _driven(rover: RoverSpec, like: Windows, seed: int) -> Windows:
    """Windows of our rover, driven steadily as the median of theirs."""
    speed = float(np.median([one.speed for one in like])) if like[0].kind != SPOT else 0.0
    wide = float(np.median([abs(one.difference) for one in like]))
    turn = max(wide, 1.1 * TURNING) / rover.controller_separation if like[0].kind != STRAIGHT else 0.0
    commands = np.array([[0.0, speed, turn]])
    recorded = replay(rover, commands, STEADY_TIME, seed=seed)
    steady = recorded.within(SETTLING, STEADY_TIME)
    return [one for one in windows(steady) if one.kind == like[0].kind]


def _median(some: Windows, name: str) -> float:
    values = [getattr(one, name) for one in some]
    return float(np.nanmedian(values)) if np.isfinite(values).any() else math.nan


def _constant(theirs: Mapping[str, Windows], ours: Mapping[str, Windows]) -> float:
    """The factor of our currents with which they are nearest to theirs, in the median of logarithms."""
    ratios = [
        _median(real, "current") / _median(ours[key], "current")
        for key, real in theirs.items()
        if ours[key]
    ]
    logs = [math.log(ratio) for ratio in ratios if math.isfinite(ratio) and ratio > 0.0]
    return math.exp(float(np.median(logs))) if logs else math.nan


def _compared(key: str, real: Windows, ours: Windows, track: float, constant: float) -> Iterator[Check]:
    count = f"real, {len(real)} windows"
    if real[0].kind == STRAIGHT:
        sd, share = _median(real, "sd"), _median(real, "share")
        span = Span(sd * math.exp(-LN_SD), sd * math.exp(LN_SD), f"{count}; |ln| at most {LN_SD}")
        yield _judged(f"{key}: sd of az", "m/s2", span, _median(ours, "sd"))
        span = Span(share - SHARE, share + SHARE, f"{count}; +-{SHARE}")
        yield _judged(f"{key}: share of 1 to 10 Hz", "", span, _median(ours, "share"))
    else:
        turned = effective_track(real, track)
        span = Span(turned * (1 - TRACK), turned * (1 + TRACK), f"{count}; +-{TRACK:.0%}")
        yield _judged(f"{key}: effective track", "m", span, effective_track(ours, track))
    current = _median(real, "current")
    span = Span(current * (1 - CURRENT), current * (1 + CURRENT), f"{count}; +-{CURRENT:.0%}")
    yield _judged(f"{key}: current", "A", span, constant * _median(ours, "current"), digits=1)


def _judged(quantity: str, unit: str, span: Span, measured: float, digits: int = 2) -> Check:
    """A check whose span is open where the real one could not be measured."""
    known = math.isfinite(span.low)
    check = Check(quantity, unit, span, measured, digits)
    return check if known else replace(check, expected=OPEN)
