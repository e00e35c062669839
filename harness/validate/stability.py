"""Statics and the tilt table: tip angles, the incline that is held, and the creep on it.

The table tilts gravity instead of the ground, which on a plane is the same. For the tip angles the
wheels' friction is raised, in place of the rail that keeps a vehicle from sliding off the table of
ISO 16333.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from harness.base.sim_time import TICK
from harness.robots import RoverSpec
from harness.robots.sections import Span
from harness.validate.check import Check, around, at_most
from harness.validate.grounds import floor
from harness.validate.rig import Rig

RAIL_FRICTION = 5.0
FAST, SLOW = math.radians(30.0), math.radians(2.5)  # [rad/s]: far from and near the angle looked for
NEAR = math.radians(5.0)
STEEPEST = math.radians(75.0)
SLIDING = 0.1  # [m/s]
STANDING = math.radians(20.0)
STANDING_TIME = 2.0  # [s]
STILL = at_most(1.0, "real: 0; E: what MuJoCo's regularised friction may leave")  # [mm/s]


@dataclass(frozen=True, slots=True)
class Balance:
    """Where the weight of a standing rover acts; horizontal distances from its centre of mass [m]."""

    height: float  # of the centre of mass over the ground [m]
    front: float  # to the front axle
    rear: float  # to the rear axle
    left: float  # to the middle of the left wheels
    right: float  # to the middle of the right wheels
    friction: float = 1.0  # of the wheels

    @property
    def arms(self) -> dict[str, float]:
        """Horizontal distance from the centre of mass to the axis about which the rover tips [m]."""
        return {
            "forward": self.front, "backward": self.rear, "to the left": self.left,
            "to the right": self.right,
        }  # fmt: skip


def balance(rig: Rig) -> Balance:
    """Returns the balance of a rover that stands on level ground."""
    model, data = rig.simulation.model, rig.simulation.data
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    x, y, z = rig.in_model_frame(data.subtree_com[1]).tolist()
    wheels = rig.in_model_frame(data.geom_xpos[rig.wheel_geoms])
    left, right = np.split(wheels, 2)
    casters = [model.body(name).id for name in rig.rover.casters]
    ahead = rig.in_model_frame(data.geom_xpos[np.isin(model.geom_bodyid, casters)])[:, 0]
    return Balance(
        height=z - float(wheels[:, 2].mean()) + rig.rover.wheel_radius,
        front=ahead.max(initial=(left[0, 0] + right[0, 0]) / 2) - x,
        rear=x - ahead.min(initial=(left[-1, 0] + right[-1, 0]) / 2),
        left=float(left[:, 1].mean()) - y,
        right=y - float(right[:, 1].mean()),
        friction=rig.rover.wheel_friction,
    )


def tip_angle(arm: float, height: float) -> float:
    """Returns the incline [rad] at which the centre of mass stands above the lower wheels."""
    return math.atan2(arm, height)


def steepest_stand(stand: Balance) -> float:
    """Returns the incline [rad] nose up at which a rover slides or tips backwards, the lower one."""
    return min(math.atan(stand.friction), tip_angle(stand.rear, stand.height))


class TiltTable:
    """A rig whose gravity tilts; `uphill` is the direction [rad] in which the ground rises."""

    def __init__(self, rig: Rig, uphill: float) -> None:
        self.rig, self.angle = rig, 0.0
        self._gravity = -float(rig.simulation.model.opt.gravity[2])
        self._uphill = np.array([math.cos(uphill), math.sin(uphill), 0.0])

    def tilt(self, angle: float) -> None:
        """Sets the incline [rad]."""
        self.angle = angle
        up = math.sin(angle) * self._uphill + np.array([0.0, 0.0, math.cos(angle)])
        self.rig.simulation.model.opt.gravity[:] = -self._gravity * up

    def raise_until(self, done: Callable[[], bool], near: float) -> float:
        """Tilts until something happens, slowly from `near` on; NaN if nothing does [rad]."""
        while self.angle < STEEPEST:
            self.tilt(self.angle + (FAST if self.angle < near else SLOW) * TICK)
            self.rig.tick()
            if done():
                return self.angle
        return math.nan


def checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """Tip angles to four sides, the incline that is held nose up, the creep on a moderate one."""
    stand = balance(Rig(rover, floor(seed)))
    half = len(rover.drive.left)
    left, right = range(half), range(half, 2 * half)
    front, rear = (0, half), (half - 1, 2 * half - 1)
    directions = ((math.pi, rear), (0.0, front), (-math.pi / 2, right), (math.pi / 2, left))
    for (name, arm), (uphill, wheels) in zip(stand.arms.items(), directions, strict=True):
        limit = tip_angle(arm, stand.height)
        source = f"D: atan({1e3 * arm:.0f} / {1e3 * stand.height:.0f} mm) of the centre of mass"
        span = around(math.degrees(limit), 1.5, source)
        measured = math.degrees(_tips(rover, seed, uphill, wheels, limit))
        yield Check(f"static tip angle {name}", "deg", span, measured, digits=1)
    yield from _held(rover, seed, stand)


def _tips(rover: RoverSpec, seed: int, uphill: float, wheels: Iterable[int], limit: float) -> float:
    rig = Rig(rover, floor(seed))
    geoms = rig.wheel_geoms
    rig.simulation.model.geom_friction[geoms, 0] = RAIL_FRICTION
    table = TiltTable(rig, rig.heading + uphill)
    watched = [geoms[wheel] for wheel in wheels]
    return table.raise_until(lambda: not rig.stands_on(watched), limit - NEAR)


def _held(rover: RoverSpec, seed: int, stand: Balance) -> Iterator[Check]:
    rig = Rig(rover, floor(seed))
    table = TiltTable(rig, rig.heading)
    table.raise_until(lambda: table.angle >= STANDING, STANDING)
    rig.run(STANDING_TIME)
    yield Check("creep on 20 deg, nose up, parked", "mm/s", STILL, creep(rig, STANDING_TIME), digits=2)
    limit = steepest_stand(stand)
    held = table.raise_until(lambda: rig.speed > SLIDING, limit - NEAR)
    source = f"D: atan(mu = {stand.friction:g}), or tips if less"
    low = Span(math.degrees(limit) - 2, math.degrees(limit) + 3, source)
    yield Check("slope held, nose up", "deg", low, math.degrees(held), digits=1)


def creep(rig: Rig, seconds: float) -> float:
    """Returns the speed at which a parked rover moves over the ground, as the crow flies [mm/s]."""
    start = rig.stance
    rig.run(seconds)
    return 1e3 * math.hypot(rig.stance.ahead - start.ahead, rig.stance.aside - start.aside) / seconds
