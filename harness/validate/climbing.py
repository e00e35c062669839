"""Uneven ground: the room below the rover, its rockers' travel, the highest kerb, the steepest ramp."""

import math
from collections.abc import Iterator
from functools import partial

import mujoco
import numpy as np

from harness.robots import RoverSpec
from harness.robots.sections import Passage, Span
from harness.validate.check import Check, around, at_most
from harness.validate.grounds import block, floor, ramp, saddle
from harness.validate.rig import Rig, largest_passing
from harness.validate.stability import Balance, balance, steepest_stand

TWIST, OVERTWIST = 0.15, 0.40  # [rad] between rocker and body that a saddle asks for
ROCKING = 1.5  # [s]
ROLLING = 1e-6  # [m/s]: wheels that are parked would keep the rockers from following
POST_AT, POST_SPEED, POST_LIMIT = 0.6, 0.3, 4.5  # [m], [m/s], [s]
SCATTER = 0.015  # [m] around the stated clearance that is searched
KERB_AT, KERB_HALF = 0.5, 1.0  # [m] ahead of the origin, at least; half its length and width
CLOSE = 0.1  # [m] between the foremost part of the rover and the kerb, at least
KERB_SPEED, KERB_LIMIT = 0.3, 7.0  # [m/s], [s]
KERBS, KERB_STEP = (0.03, 0.14), 0.005  # [m]
FINE_STEP = 1e-3  # [m] of the limit by statics
RAMP_SPEED, RAMP_LIMIT = 0.4, 12.0  # [m/s], [s]
RAMP_TOP = 2.6  # [m] ahead: more than a metre at the full incline
RAMPS = (20, 50)  # [deg]


def passage_checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """The highest rock that passes below each place of the rover that has been measured."""
    for passage in rover.expected.passages:
        stated, passes = passage.height, partial(_passes, rover, seed, passage)
        highest = largest_passing(passes, stated - SCATTER, stated + SCATTER, 0.001)
        source = f"{passage.source}; D: up to 5 mm of sink, heave"
        span = Span(stated - 0.005, stated + 0.001, source)
        yield Check(f"highest rock that passes below the {passage.name}", "m", span, highest)


def _passes(rover: RoverSpec, seed: int, passage: Passage, height: float) -> bool:
    post = block("cylinder", (passage.radius, height / 2), x=POST_AT, y=passage.aside)
    rig = Rig(rover, floor(seed, post))
    rig.command(POST_SPEED)
    return not rig.run_until(lambda: rig.touches_block, POST_LIMIT)


def rocker_checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """The rockers' travel, of a rover that has some."""
    rockers = _rockers(Rig(rover, floor(seed)).simulation.model)
    if not rockers:
        return
    turned = _twisted(rover, seed, TWIST, rockers)
    follows = around(TWIST, 0.012, "D: the saddle's twist, all wheels on the ground")
    yield Check(f"rocker angle on a saddle of {TWIST:g} rad", "rad", follows, turned)
    limited = _twisted(rover, seed, OVERTWIST, rockers)
    stop = rover.expected.rocker_stop
    yield Check("rocker angle at its stops", "rad", stop, limited)
    rig = Rig(rover, floor(seed, block("box", (0.05, 0.5, 0.025), x=0.5, y=0.52)))
    uneven: list[float] = []
    rig.observers.append(lambda: uneven.append(abs(rig.joint_angles(rockers).sum())))
    rig.command(0.4)
    rig.run(3.0)
    mirrored = at_most(5e-4, "facts: a stiff differential")
    yield Check("largest |q_L + q_R| over a 5 cm bar", "rad", mirrored, max(uneven), digits=5)


def _rockers(model: mujoco.MjModel) -> tuple[str, ...]:
    """The two joints of which one turns as far as the other turns back, if there are such."""
    for tie in range(model.neq):
        if model.eq_type[tie] == mujoco.mjtEq.mjEQ_JOINT and model.eq_data[tie, 1] == -1.0:
            return model.joint(model.eq_obj1id[tie]).name, model.joint(model.eq_obj2id[tie]).name
    return ()


def _twisted(rover: RoverSpec, seed: int, angle: float, rockers: tuple[str, ...]) -> float:
    """The largest angle of a rocker on a saddle that asks for that [rad]."""
    rig = Rig(rover, saddle(seed, 2 * math.tan(angle) / rover.track))
    rig.command(ROLLING)
    rig.run(ROCKING)
    return float(np.abs(rig.joint_angles(rockers)).max())


def checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """Kerbs and ramps; each limit is found by bisection, one drive per try."""
    stand = balance(Rig(rover, floor(seed)))
    statics = f"D: statics of the rear wheels, mu {stand.friction:g}, no run-up"
    for way, aside, span in (
        ("head-on", 0.0, Span(kerb_limit(rover, stand), math.inf, statics)),
        ("one side", KERB_HALF + 0.05, rover.expected.kerb_one_side),
    ):
        yield Check(f"kerb climbed, {way}", "m", span, _kerb(rover, seed, aside))
    limit = math.degrees(steepest_stand(stand))
    lesser = f"D: atan(mu = {stand.friction:g}) or the tip angle, whichever is less"
    source = f"{rover.expected.ramp_source}{lesser}"
    span = Span(limit - 3.0, limit + 1.5, source)
    yield Check("slope climbed, 0.4 m/s commanded", "deg", span, _ramp(rover, seed), digits=0)


def _kerb(rover: RoverSpec, seed: int, aside: float) -> float:
    ahead = max(KERB_AT, rover.footprint[1] + CLOSE)
    passed = ahead + rover.wheelbase / 2 + rover.wheel_radius + 0.05

    def climbs(height: float) -> bool:
        half = (KERB_HALF, KERB_HALF, height / 2)
        kerb = block("box", half, x=ahead + KERB_HALF, y=aside)
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
    mu, radius = balance.friction, rover.wheel_radius
    pitch, edge = math.asin(height / rover.wheelbase), math.acos(1 - height / radius)
    lever = rover.wheelbase * math.cos(pitch) - radius * math.sin(edge)
    behind = balance.front * math.cos(pitch) + (balance.height - radius) * math.sin(pitch)
    normal = behind / (lever * (math.cos(edge) + mu * math.sin(edge)))  # over the weight
    return normal * math.sin(edge) * (1 + mu**2) <= mu
