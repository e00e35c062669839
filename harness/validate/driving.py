"""On a level floor: the IMU at rest, speed, stopping distance, yaw ratio, calm while turning."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import HIGHEST_RATE, TICK
from harness.robots import RoverSpec
from harness.robots.sections import Span
from harness.validate.check import Check, around, at_most
from harness.validate.grounds import floor
from harness.validate.rig import Rig

CRUISE, TOP = 0.5, 1.0  # [m/s] commanded
ACCELERATING, MEASURING, TURNING = 0.8, 1.0, 4.0  # [s]
IMU_RATE = 20  # [Hz]
REST_BEFORE, REST = 1.0, 2.0  # [s]
YAW_RATE, ARC_SPEED = 1.0, 0.3  # [rad/s], [m/s] commanded

Magnitudes = NDArray[np.float64]


def rest_checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """Yields what the IMU reads at rest: gravity, and nothing that varies."""
    rig = Rig(rover, floor(seed))
    rig.run(REST_BEFORE)
    force, rate = at_rest(rig, IMU_RATE, REST)
    gravity = around(rover.gravity, 0.005, "S: gravity of RoboTerrain's worlds, noise off")
    yield Check("IMU at rest, |a|", "m/s2", gravity, float(force.mean()), digits=4)
    still = at_most(1e-3, "S: no noise in RoboTerrain's sensors")
    yield Check("IMU at rest, sd of |a|", "m/s2", still, float(force.std()), digits=4)
    yield Check("IMU at rest, largest |w|", "rad/s", still, float(rate.max()), digits=4)


def at_rest(rig: Rig, rate: int, seconds: float) -> tuple[Magnitudes, Magnitudes]:
    """Returns the magnitudes of the IMU's readings: of acceleration [m/s^2] and of turning [rad/s].

    Args:
        rig: The rover, standing.
        rate: Of the IMU [Hz].
        seconds: How long it is read.
    """
    readings = rig.imu_readings(rate, seconds)
    force = np.linalg.norm([reading.linear_acceleration for reading in readings], axis=1)
    return force, np.linalg.norm([reading.angular_velocity for reading in readings], axis=1)


def checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """Everything that a level floor can tell of driving."""
    expected, rig = rover.expected, Rig(rover, floor(seed))
    slow = expected.speed_ratio
    spans = {v: Span(v * slow.low, v * slow.high, slow.source) for v in (0.1, 0.3)}
    for commanded, span in (spans | {CRUISE: expected.at_half, TOP: expected.at_top}).items():
        speed, _ = straight(rig, commanded)
        yield Check(f"speed at {commanded:g} m/s commanded", "m/s", span, speed, digits=4)
    yield _stopping(rover, seed)
    yield from _turning(rover, seed)


def straight(
    rig: Rig, commanded: float, accelerating: float = ACCELERATING, measuring: float = MEASURING
) -> tuple[float, float]:
    """Drives straight on; returns the ground speed [m/s], negative backwards, and the turn [rad/m].

    Args:
        rig: The rover.
        commanded: Speed [m/s].
        accelerating: Time before the speed is measured [s].
        measuring: Time over which it is measured [s].
    """
    rig.command(commanded)
    rig.run(accelerating)
    start = rig.stance
    rig.run(measuring)
    ahead, aside = rig.stance.ahead - start.ahead, rig.stance.aside - start.aside
    way = math.hypot(ahead, aside)
    turned = (rig.stance.yaw - start.yaw) / way if way else math.nan
    return math.copysign(way, ahead) / measuring, turned


def _stopping(rover: RoverSpec, seed: int) -> Check:
    rig = Rig(rover, floor(seed))
    speed, _ = straight(rig, CRUISE)
    start = rig.stance.ahead
    rig.command(0.0)
    rig.run(MEASURING)
    gripped = rover.wheel_friction * rover.gravity
    rate = min(rover.linear_acceleration, gripped)
    braking = speed**2 / (2 * rate)
    limit = "SDF" if rate < gripped else "friction"
    source = f"D: v^2 / 2a, a = {rate:g} m/s2 ({limit}), and a tick or two"
    span = Span(braking - speed * TICK, braking + 2 * speed * TICK, source)
    distance = rig.stance.ahead - start
    return Check(f"stopping distance from {CRUISE:g} m/s commanded", "m", span, distance, digits=4)


def _turning(rover: RoverSpec, seed: int) -> Iterator[Check]:
    rig = Rig(rover, floor(seed))
    if rover.steers:
        follows = around(1.0, 0.1, "D: steered wheels roll about one centre; E: slip to 10 %")
        curve = yaw_ratio(rig, ARC_SPEED, 0.5 * ARC_SPEED / rover.tightest_turn)
        yield Check("yaw ratio in a curve, 0.3 m/s", "", follows, curve)
        return
    in_place = yaw_ratio(rig, 0.0)
    yield Check("yaw ratio in place, 1 rad/s commanded", "", rover.expected.yaw_ratio, in_place)
    calm = at_most(0.3, "facts: no contact chatter, which no real rover has")
    if not rover.expected.turning_shake.is_open:
        calm = rover.expected.turning_shake
    yield Check("sd of az turning in place, IMU at 100 Hz", "m/s2", calm, shaking(rig, TURNING))
    source = "D: in place +-10 %, as centres of rotation hardly move (Mandow et al. 2007)"
    constant = Span(0.9 * in_place, 1.1 * in_place, source)
    yield Check("yaw ratio in an arc, 0.3 m/s", "", constant, yaw_ratio(rig, ARC_SPEED))


def yaw_ratio(rig: Rig, speed: float, yaw_rate: float = YAW_RATE, turning: float = TURNING) -> float:
    """Returns the yaw rate over the commanded one, once it has been reached.

    Args:
        rig: The rover.
        speed: Commanded [m/s].
        yaw_rate: Commanded [rad/s].
        turning: Time over which it is measured [s].
    """
    rig.command(speed, yaw_rate)
    rig.run(MEASURING)
    start = rig.stance.yaw
    rig.run(turning)
    return (rig.stance.yaw - start) / (yaw_rate * turning)


def shaking(rig: Rig, seconds: float) -> float:
    """Returns the standard deviation of az of an IMU at 100 Hz while the rover drives on [m/s^2]."""
    return float(np.std([imu.linear_acceleration[2] for imu in rig.imu_readings(HIGHEST_RATE, seconds)]))
