"""What is odd about a rover: its masses, how it stands, drives, turns and parks on flat ground.

The spans are wide: they catch mistakes of a model, such as millimetres for metres or an axis that points
backwards, not a rover that is merely unusual.
"""

import math
from collections.abc import Iterator
from functools import partial

import mujoco
import numpy as np

from harness.base.errors import RunFailed
from harness.base.sim_time import HIGHEST_RATE
from harness.robots import RoverSpec
from harness.robots.model import compiled_alone
from harness.validate.check import Check, Span, around, at_most
from harness.validate.grounds import Course
from harness.validate.rig import Rig
from harness.validate.stability import balance, tip_angle
from harness.world.heightfield import Heightfield
from harness.world.world import World

HALF_SIZE, CELL = 60, 1.0  # [m]: perfectly flat
MASSES = Span(0.2, 2000.0, "toys to field robots")
GYRATION = Span(0.1, 1.5, "0.4 to 0.6 of solid bodies, 1 of shells")
TIPS = Span(15.0, 80.0, "lower: falls over; higher: is there a mass?")
RESTING, PARKED, MEASURED = 1.0, 2.0, 1.5  # [s]
FASTEST_TEST = 20.0  # [m] at most of a test drive
GRIP = Span(0.2, 1.5, "rubber on rock 0.6 to 1; the larger of wheel and ground without a priority")


def flat() -> Course:
    """Returns a level plane of 120 m x 120 m."""
    heights = np.zeros((2 * HALF_SIZE + 1, 2 * HALF_SIZE + 1))
    return Course(World("check", Heightfield(heights, CELL), (), 0, 0.0), 0.0)


def check_up(rover: RoverSpec) -> list[Check]:
    """Returns what was found of a rover; what lies outside its span is odd."""
    parts = (_masses, _standing, _straight, _turning)
    return [check for part in parts for check in _safely(part, rover)]


def _safely(part: partial[Iterator[Check]] | object, rover: RoverSpec) -> Iterator[Check]:
    """The checks of a part; where the simulation fails that is one."""
    try:
        yield from part(rover)  # type: ignore[operator]  # a generator function
    except RunFailed as error:
        yield Check("simulation", "", Span(0.0, 0.0, str(error)), math.nan)


def _masses(rover: RoverSpec) -> Iterator[Check]:
    model, data = compiled_alone(rover)
    yield Check("mass", "kg", MASSES, float(model.body_mass.sum()), digits=2)
    ratios = {}
    for body in range(1, model.nbody):
        size = _half_diagonal(model, data, body)
        if model.body_mass[body] > 0 and size:
            gyration = math.sqrt(model.body_inertia[body].max() / model.body_mass[body])
            ratios[model.body(body).name] = gyration / size
    for name in sorted({min(ratios, key=ratios.__getitem__), max(ratios, key=ratios.__getitem__)}):
        what = f"radius of gyration of '{name}' / half its diagonal"
        yield Check(what, "", GYRATION, ratios[name], digits=2)
    motors = {int(model.joint(name).bodyid[0]) for name in rover.wheel_joints}
    tyres = [g for g in range(model.ngeom) if model.geom_bodyid[g] in motors and model.geom_contype[g]]
    grip = max(
        model.geom_friction[g, 0] if model.geom_priority[g] else max(1.0, model.geom_friction[g, 0])
        for g in tyres
    )
    yield Check("friction of the wheels that counts", "", GRIP, float(grip), digits=2)


def _half_diagonal(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> float:
    """Of the boxes around what is fixed to a body [m]; 0 if nothing is."""
    from harness.robots.model import extent  # noqa: PLC0415

    geoms = np.flatnonzero(model.geom_bodyid == body).tolist()
    low, high = extent(model, data, geoms)
    return float(np.linalg.norm(high - low)) / 2 if geoms else 0.0


def _standing(rover: RoverSpec) -> Iterator[Check]:
    rig = Rig(rover, flat())
    stand = balance(rig)
    for name, arm in (
        ("forward", stand.front),
        ("backward", stand.rear),
        ("left", stand.left),
        ("right", stand.right),
    ):
        angle = math.degrees(tip_angle(arm, stand.height))
        yield Check(f"tip angle {name}, by its centre of mass", "deg", TIPS, angle, digits=0)
    rig.run(RESTING)
    shares = _wheel_loads(rig)
    wheels = len(shares)
    source = "all wheels carry; suspensions share the load"
    for name, share in zip(rover.wheel_names, shares, strict=True):
        if share in (min(shares), max(shares)):
            yield Check(
                f"load of the {name.replace('_', ' ')} wheel / its share",
                "",
                Span(0.2, 2.5, source),
                share * wheels,
                digits=2,
            )
    rest = around(rover.gravity, 0.05, "gravity")
    readings = rig.imu_readings(HIGHEST_RATE, 0.5)
    force = [float(np.linalg.norm(reading.linear_acceleration)) for reading in readings]
    yield Check("IMU at rest, |a|", "m/s2", rest, float(np.mean(force)))
    start = rig.stance
    rig.run(PARKED)
    creep = 1e3 * math.hypot(rig.stance.ahead - start.ahead, rig.stance.aside - start.aside) / PARKED
    yield Check("creep when parked", "mm/s", at_most(1.0, "a parked rover stands"), creep, digits=2)
    scraping = sum(1 for name in _scraping(rig) if name)
    yield Check(
        "parts of the body on the ground", "", at_most(0.0, "wheels alone touch it"), scraping, digits=0
    )


def _wheel_loads(rig: Rig) -> list[float]:
    """The share of the weight that each wheel carries."""
    model, data = rig.simulation.model, rig.simulation.data
    wheels = [int(model.joint(name).bodyid[0]) for name in rig.rover.wheel_joints]
    loads, force = dict.fromkeys(wheels, 0.0), np.zeros(6)
    for index, geoms in enumerate(data.contact.geom.tolist()):
        mujoco.mj_contactForce(model, data, index, force)
        for geom in geoms:
            body = int(model.body_weldid[model.geom_bodyid[geom]])
            if body in loads:
                loads[body] += float(force[0]) * abs(float(data.contact.frame[index][2]))
    weight = float(model.body_mass.sum()) * rig.rover.gravity
    return [loads[body] / weight for body in wheels]


def _scraping(rig: Rig) -> set[str]:
    return {
        touch and "scrape"
        for kind, touch in rig.simulation.contacts.strongest.items()
        if kind == "scrape"
    }


def _straight(rover: RoverSpec) -> Iterator[Check]:
    rig = Rig(rover, flat())
    believed = rover.wheel_radius / rover.controller_radius
    for what, speed in (("cruising", rover.cruise_speed), ("top", rover.top_speed / believed)):
        reached, turned = _driven(rig, speed)
        source = "motors that are strong enough, axes that point to the left"
        span = around(believed, 0.1, source)
        yield Check(
            f"speed reached / commanded, {what} {speed:.2f} m/s", "", span, reached / speed, digits=2
        )
    straight = around(0.0, 5.0, "both sides drive alike")
    yield Check("turned on the way", "deg/m", straight, turned, digits=2)


def _driven(rig: Rig, speed: float) -> tuple[float, float]:
    """The speed once it is reached [m/s], and the turn by the way [deg/m]."""
    rig.command(speed)
    rig.run(speed / rig.rover.linear_acceleration + 1.0)
    start, seconds = rig.stance, min(MEASURED, FASTEST_TEST / speed)
    rig.run(seconds)
    ahead = rig.stance.ahead - start.ahead
    way = math.hypot(ahead, rig.stance.aside - start.aside)
    turned = math.degrees(rig.stance.yaw - start.yaw) / way if way else math.nan
    rig.command(0.0)
    rig.run(speed / rig.rover.linear_acceleration + 0.5)
    return math.copysign(way, ahead) / seconds, turned


def _turning(rover: RoverSpec) -> Iterator[Check]:
    rig = Rig(rover, flat())
    rate = rover.cruise_yaw_rate
    if rover.steers:
        speed = rover.cruise_speed
        rate = 0.7 * speed / rover.tightest_turn
        rig.command(speed, rate)
        span = Span(0.8, 1.15, "steered wheels roll about one centre")
    else:
        rig.command(0.0, rate)
        span = Span(0.15, 1.2, "1 with narrow tyres; long wheelbases turn less")
    rig.run(1.5)
    start = rig.stance.yaw
    vertical = [imu.linear_acceleration[2] for imu in rig.imu_readings(HIGHEST_RATE, 2.0)]
    ratio = (rig.stance.yaw - start) / (2.0 * rate)
    how = "in a curve" if rover.steers else "in place"
    yield Check(f"yaw rate reached / commanded, {how}, {rate:.2f} rad/s", "", span, ratio, digits=2)
    calm = at_most(1.0, "contacts that do not chatter: solimp of models/leo/leo.xml")
    yield Check("sd of az while turning, IMU at 100 Hz", "m/s2", calm, float(np.std(vertical)), digits=2)
    if "scrape" in rig.simulation.contacts.strongest:
        yield Check(
            "body on the ground while turning", "", at_most(0.0, "wheels alone touch it"), 1.0, digits=0
        )
