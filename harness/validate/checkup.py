"""What is odd about a rover: its masses, how it stands, drives, turns and parks on flat ground.

The manoeuvres are those of the validation. The spans are wide: they catch mistakes of a model, such as
millimetres for metres or an axis that points backwards, not a rover that is merely unusual.
"""

import math
from collections.abc import Iterator

import mujoco
import numpy as np

from harness.base.errors import RunFailed
from harness.base.sim_time import HIGHEST_RATE
from harness.physics.scene import motors_of
from harness.robots import RoverSpec
from harness.robots.model import COLLIDING_GROUP, SEEN_GROUP, STIFFEST, compiled_alone, extent
from harness.robots.sections import Span
from harness.validate.check import Check, around, at_most
from harness.validate.driving import at_rest, shaking, straight, yaw_ratio
from harness.validate.grounds import flat
from harness.validate.rig import Rig
from harness.validate.stability import balance, creep, tip_angle

MASSES = Span(0.2, 2000.0, "toys to field robots")
LOOKS = Span(0.2, 5.0, 'URDF and MJCF are in metres; of a mesh in mm scale="0.001 0.001 0.001"')
GYRATION = Span(0.1, 1.5, "0.4 to 0.6 of solid bodies, 1 of shells")
TIPS = Span(15.0, 80.0, "lower: falls over; higher: is there a mass?")
GRIP = Span(0.2, 1.5, "rubber on rock 0.6 to 1; the larger of wheel and ground without a priority")
LOADS = Span(0.2, 2.5, "all wheels carry; suspensions share the load")
PARKED = at_most(1.0, "a parked rover stands")
STRAIGHT = around(0.0, 5.0, "both sides drive alike")
IN_A_CURVE = Span(0.8, 1.15, "steered wheels roll about one centre")
IN_PLACE = Span(0.15, 1.2, "1 with narrow tyres; long wheelbases turn less")
CALM = at_most(
    1.0, 'contacts that do not chatter; on wheels solref="0.02 1" solimp="0.15 0.95 0.002 0.5 2"'
)
SERVOS = at_most(
    STIFFEST, "else one at its limit flips to the other in each step: lower kv, or more armature"
)
WHEELS_ALONE = at_most(0.0, "wheels and casters alone touch it")
DC_GAIN = 6  # where MuJoCo keeps the gain of a <dcmotor>'s controller
STANDING, PARKING, MEASURING, TURNING = 1.0, 2.0, 1.5, 2.0  # [s]
LONGEST_WAY, RUN_UP = 20.0, 35.0  # [m] of a test drive and before it, at most: both fit the plane
SHARP = 0.7  # of the curvature of the tightest turn


def check_up(rover: RoverSpec) -> list[Check]:
    """Returns what was measured of a rover; what lies outside its span is odd."""
    return [
        check for part in (_masses, _standing, _straight, _turning) for check in _safely(part(rover))
    ]


def _safely(checks: Iterator[Check]) -> Iterator[Check]:
    """Yields checks; if the simulation fails that is the last one."""
    try:
        yield from checks
    except RunFailed as error:
        yield Check("failures of the simulation", "", at_most(0.0, str(error)), 1.0, digits=0)


def _masses(rover: RoverSpec) -> Iterator[Check]:
    model, data = compiled_alone(rover)
    yield Check("mass", "kg", MASSES, float(model.body_mass.sum()), digits=2)
    groups = (SEEN_GROUP, COLLIDING_GROUP)
    boxes = [extent(model, data, np.flatnonzero(model.geom_group == group).tolist()) for group in groups]
    seen, felt = (float(np.linalg.norm(high - low)) for low, high in boxes)
    if math.isfinite(seen / felt):
        yield Check("size of what is seen / of what collides", "", LOOKS, seen / felt, digits=2)
    ratios = {}
    for body in range(1, model.nbody):
        geoms = np.flatnonzero(model.geom_bodyid == body).tolist()
        low, high = extent(model, data, geoms)
        if model.body_mass[body] > 0 and geoms:
            gyration = math.sqrt(model.body_inertia[body].max() / model.body_mass[body])
            ratios[model.body(body).name] = gyration / (float(np.linalg.norm(high - low)) / 2)
    for name in sorted({min(ratios, key=ratios.__getitem__), max(ratios, key=ratios.__getitem__)}):
        quantity = f"radius of gyration of '{name}' / half its diagonal"
        yield Check(quantity, "", GYRATION, ratios[name], digits=2)
    yield Check("friction of the wheels that counts", "", GRIP, rover.wheel_friction, digits=2)


def _standing(rover: RoverSpec) -> Iterator[Check]:
    rig = Rig(rover, flat())
    stand = balance(rig)
    for name, arm in stand.arms.items():
        angle = math.degrees(tip_angle(arm, stand.height))
        yield Check(f"tip angle {name}, by its centre of mass", "deg", TIPS, angle, digits=0)
    rig.run(STANDING)
    quantity = "gain of a wheel's servo x timestep / the inertia that it turns"
    yield Check(quantity, "", SERVOS, _servo_stiffness(rig), digits=1)
    shares = wheel_loads(rig)
    for name, share in zip(rover.wheel_names, shares, strict=True):
        if share in (min(shares), max(shares)):
            quantity = f"load of the {name.replace('_', ' ')} wheel / its share"
            yield Check(quantity, "", LOADS, share * len(shares), digits=2)
    force, _ = at_rest(rig, HIGHEST_RATE, 0.5)
    gravity = around(rover.gravity, 0.05, "gravity")
    yield Check("IMU at rest, |a|", "m/s2", gravity, float(force.mean()))
    yield Check("creep when parked", "mm/s", PARKED, creep(rig, PARKING), digits=2)
    yield _on_the_ground(rig, "standing")


def _servo_stiffness(rig: Rig) -> float:
    """The largest of all driven wheels.

    MuJoCo takes a servo's torque at its limit as constant in a step: beyond 2 that may turn an error
    round, for ever without friction.
    """
    model, names = rig.simulation.model, rig.rover.drive.driven
    motors = motors_of(model, names)
    dofs = [int(model.joint(name).dofadr[0]) for name in names]
    gains = np.maximum(-model.actuator_biasprm[motors, 2], model.actuator_gainprm[motors, DC_GAIN])
    stiff = gains * model.actuator_gear[motors, 0] ** 2 * model.opt.timestep / model.dof_M0[dofs]
    return float(stiff.max())


def wheel_loads(rig: Rig) -> list[float]:
    """Returns the share of the weight that each wheel carries, in the order of the wheel joints."""
    model, data = rig.simulation.model, rig.simulation.data
    wheels = [int(model.joint(name).bodyid[0]) for name in rig.rover.wheel_joints]
    loads, force = dict.fromkeys(wheels, 0.0), np.zeros(6)
    for index, geoms in enumerate(data.contact.geom):
        mujoco.mj_contactForce(model, data, index, force)
        for body in model.body_weldid[model.geom_bodyid[geoms]].tolist():
            if body in loads:
                loads[body] += float(force[0]) * abs(float(data.contact.frame[index][2]))
    weight = float(model.body_mass.sum()) * rig.rover.gravity
    return [loads[body] / weight for body in wheels]


def _on_the_ground(rig: Rig, doing: str) -> Check:
    scrapes = float("scrape" in rig.simulation.contacts.strongest)
    return Check(f"body on the ground while {doing}", "", WHEELS_ALONE, scrapes, digits=0)


def _straight(rover: RoverSpec) -> Iterator[Check]:
    believed = rover.wheel_radius / rover.controller_radius
    reached = around(believed, 0.1, "motors that are strong enough, axes that point to the left")
    rate = rover.linear_acceleration
    fastest = math.sqrt(rate * (rate + 2 * RUN_UP)) - rate  # run-up: v^2 / 2a, and a second at v
    for name, wished in (("cruising", rover.cruise_speed), ("top", rover.top_speed / believed)):
        speed = min(wished, fastest)
        measuring = min(MEASURING, LONGEST_WAY / speed)
        ground_speed, turned = straight(Rig(rover, flat()), speed, speed / rate + 1.0, measuring)
        quantity = f"speed reached / commanded, {name} {speed:.2f} m/s"
        yield Check(quantity, "", reached, ground_speed / speed, digits=2)
    yield Check("turned on the way", "deg/m", STRAIGHT, math.degrees(turned), digits=2)


def _turning(rover: RoverSpec) -> Iterator[Check]:
    rig, speed, rate, how, span = Rig(rover, flat()), 0.0, rover.cruise_yaw_rate, "in place", IN_PLACE
    if rover.steers:
        speed, how, span = rover.cruise_speed, "in a curve", IN_A_CURVE
        rate = SHARP * speed / rover.tightest_turn
    ratio = yaw_ratio(rig, speed, rate, TURNING)
    quantity = f"yaw rate reached / commanded, {how}, {rate:.2f} rad/s"
    yield Check(quantity, "", span, ratio, digits=2)
    yield Check("sd of az while turning, IMU at 100 Hz", "m/s2", CALM, shaking(rig, TURNING), digits=2)
    yield _on_the_ground(rig, "turning")
