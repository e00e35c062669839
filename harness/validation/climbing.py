"""Climbing: the highest kerb, head-on and with one side, and the steepest ramp."""

import math
from collections.abc import Iterator

import numpy as np

from harness.robots import RoverSpec
from harness.validation.check import Check, Span, expected_of
from harness.validation.grounds import block, floor, ramp
from harness.validation.rig import Rig, largest_passing
from harness.validation.stability import WHEEL_FRICTION, Balance, balance, steepest_stand

KERB_AT, KERB_HALF = 0.5, 1.0  # [m] ahead of the origin; half its length and width
KERB_SPEED, KERB_LIMIT = 0.3, 7.0  # [m/s], [s]
KERBS, KERB_STEP = (0.03, 0.14), 0.005  # [m]
FINE_STEP = 1e-3  # [m] of the limit by statics
RAMP_SPEED, RAMP_LIMIT = 0.4, 12.0  # [m/s], [s]
RAMP_TOP = 2.6  # [m] ahead: more than a metre at the full incline
RAMPS = (20, 50)  # [deg]


def checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """Kerbs and ramps; each limit is found by bisection, one drive per try."""
    stand = balance(Rig(rover, floor(seed)))
    pulled_up = Span(
        kerb_limit(rover, stand), math.inf, "D: statics of the rear wheels, mu 1, no run-up"
    )
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
        kerb = block("box", half, x=KERB_AT + KERB_HALF, y=aside)
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


def kerb_limit(rover: RoverSpec, balance: Balance) -> float:
    """Returns the highest kerb [m] that the rear wheels climb head-on without run-up, with all wheels.

    The front wheels are on top, the rear ones touch the edge; both pull at the friction limit. The
    balance of moments about the front contact gives the rear normal force, that of the horizontal
    forces the limit N sin(theta) (1 + mu^2) <= mu W.
    """
    heights = np.arange(FINE_STEP, rover.wheel_radius, FINE_STEP)
    passed = [height for height in heights if _rear_wheels_climb(height, rover, balance)]
    return float(passed[-1]) if passed else 0.0


def _rear_wheels_climb(height: float, rover: RoverSpec, balance: Balance) -> bool:
    mu, radius = WHEEL_FRICTION, rover.wheel_radius
    pitch, edge = math.asin(height / rover.wheelbase), math.acos(1 - height / radius)
    lever = rover.wheelbase * math.cos(pitch) - radius * math.sin(edge)
    behind = balance.front * math.cos(pitch) + (balance.height - radius) * math.sin(pitch)
    normal = behind / (lever * (math.cos(edge) + mu * math.sin(edge)))  # over the weight
    return normal * math.sin(edge) * (1 + mu**2) <= mu
