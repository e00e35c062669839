"""Climbing: the highest kerb, head-on and with one side, and the steepest ramp."""

import math
from collections.abc import Iterator

from harness.robots import RoverSpec
from harness.validation.check import Check, Span, at_least, expected_of
from harness.validation.grounds import Block, floor, ramp
from harness.validation.rig import Rig, largest_passing
from harness.validation.stability import steepest_stand
from harness.validation.statics import balance, kerb_limit

KERB_AT, KERB_HALF = 0.5, 1.0  # [m] ahead of the origin; half its length and width
KERB_SPEED, KERB_LIMIT = 0.3, 7.0  # [m/s], [s]
KERBS, KERB_STEP = (0.03, 0.14), 0.005  # [m]
RAMP_SPEED, RAMP_LIMIT = 0.4, 12.0  # [m/s], [s]
RAMP_TOP = 2.6  # [m] ahead: more than a metre at the full incline
RAMPS = (20, 50)  # [deg]


def checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """Kerbs and ramps; each limit is found by bisection, one drive per try."""
    stand = balance(Rig(rover, floor(seed)))
    pulled_up = at_least(kerb_limit(rover, stand), "D: statics of the rear wheels, mu 1, no run-up")
    yield Check("kerb climbed, head-on", "m", pulled_up, _kerb(rover, seed, one_side=False))
    expected = expected_of(rover)
    yield Check("kerb climbed, one side", "m", expected.kerb_one_side, _kerb(rover, seed, one_side=True))
    limit = math.degrees(steepest_stand(stand))
    source = f"{expected.ramp_source}D: atan(mu = 1) or the tip angle, whichever is less"
    span = Span(limit - 3.0, limit + 1.5, source)
    yield Check("slope climbed, 0.4 m/s commanded", "deg", span, _ramp(rover, seed), digits=0)


def _kerb(rover: RoverSpec, seed: int, *, one_side: bool) -> float:
    aside = KERB_HALF + 0.05 if one_side else 0.0
    passed = KERB_AT + rover.wheelbase / 2 + rover.wheel_radius + 0.05

    def climbs(height: float) -> bool:
        half = (KERB_HALF, KERB_HALF, height / 2)
        kerb = Block(shape="box", half_size=half, x=KERB_AT + KERB_HALF, y=aside)
        rig = Rig(rover, floor(seed, kerb))
        rig.command(KERB_SPEED)
        return rig.run_until(lambda: rig.stance.ahead > passed, KERB_LIMIT)

    return largest_passing(climbs, *KERBS, KERB_STEP)


def _ramp(rover: RoverSpec, seed: int) -> float:
    def climbs(degrees: float) -> bool:
        rig = Rig(rover, ramp(seed, math.radians(degrees)))
        rig.command(RAMP_SPEED)
        return rig.run_until(lambda: rig.stance.ahead > RAMP_TOP, RAMP_LIMIT)

    return largest_passing(climbs, *RAMPS, 1.0)
