"""Standing still and passing over: the IMU at rest, the rockers' travel, the room below the rover."""

import math
from collections.abc import Iterator

import numpy as np

from harness.robots import RoverSpec
from harness.validation.check import Check, Passage, Span, around, at_most, expected_of
from harness.validation.grounds import block, floor, saddle
from harness.validation.rig import Rig, largest_passing

IMU_RATE = 20  # [Hz]
REST_BEFORE, REST = 1.0, 2.0  # [s]
TWIST, OVERTWIST = 0.15, 0.40  # [rad] between rocker and body that a saddle asks for
ROCKING = 1.5  # [s]
POST_AT, POST_SPEED, POST_LIMIT = 0.6, 0.3, 4.5  # [m], [m/s], [s]
SCATTER = 0.015  # [m] around the stated clearance that is searched


def checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """IMU at rest, clearance, and the rockers of a rover that has some."""
    yield from _rest(rover, seed)
    for passage in expected_of(rover).passages:
        yield _clearance(rover, seed, passage)
    if rover.passive_joints:
        yield from _rockers(rover, seed)


def _rest(rover: RoverSpec, seed: int) -> Iterator[Check]:
    rig = Rig(rover, floor(seed))
    rig.run(REST_BEFORE)
    readings = rig.imu_readings(IMU_RATE, REST)
    force = np.linalg.norm([reading.linear_acceleration for reading in readings], axis=1)
    rate = np.linalg.norm([reading.angular_velocity for reading in readings], axis=1)
    gravity = around(rover.gravity, 0.005, "S: gravity of RoboTerrain's worlds, noise off")
    yield Check("IMU at rest, |a|", "m/s2", gravity, float(force.mean()), digits=4)
    still = at_most(1e-3, "S: no noise in RoboTerrain's sensors")
    yield Check("IMU at rest, sd of |a|", "m/s2", still, float(force.std()), digits=4)
    yield Check("IMU at rest, largest |w|", "rad/s", still, float(rate.max()), digits=4)


def _clearance(rover: RoverSpec, seed: int, passage: Passage) -> Check:
    def passes(height: float) -> bool:
        half = (passage.radius, height / 2)
        post = block("cylinder", half, x=POST_AT, y=passage.aside)
        rig = Rig(rover, floor(seed, post))
        rig.command(POST_SPEED)
        return not rig.run_until(lambda: rig.touches_block, POST_LIMIT)

    highest = largest_passing(passes, passage.height - SCATTER, passage.height + SCATTER, 0.001)
    span = Span(
        passage.height - 0.005, passage.height + 0.001, f"{passage.source}; D: up to 5 mm of sink, heave"
    )
    return Check(f"highest rock that passes below the {passage.name}", "m", span, highest)


def _rockers(rover: RoverSpec, seed: int) -> Iterator[Check]:
    turned = _twisted(rover, seed, TWIST)
    follows = around(TWIST, 0.012, "D: the saddle's twist, all wheels on the ground")
    yield Check(
        f"rocker angle on a saddle of {TWIST:g} rad", "rad", follows, float(np.abs(turned).max())
    )
    limited = _twisted(rover, seed, OVERTWIST)
    stop = expected_of(rover).rocker_stop
    yield Check("rocker angle at its stops", "rad", stop, float(np.abs(limited).max()))
    rig = Rig(rover, floor(seed, block("box", (0.05, 0.5, 0.025), x=0.5, y=0.52)))
    uneven: list[float] = []
    rig.observers.append(lambda: uneven.append(abs(rig.joint_angles(rover.passive_joints).sum())))
    rig.command(0.4)
    rig.run(3.0)
    mirrored = at_most(5e-4, "facts: a stiff differential")
    yield Check("largest |q_L + q_R| over a 5 cm bar", "rad", mirrored, max(uneven), digits=5)


def _twisted(rover: RoverSpec, seed: int, angle: float) -> np.ndarray:
    rig = Rig(rover, saddle(seed, 2 * math.tan(angle) / rover.track))
    rig.run(ROCKING)
    return rig.joint_angles(rover.passive_joints)
