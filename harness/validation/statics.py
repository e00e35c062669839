"""What rigid-body statics allows a rover: tip angles, the kerb it pulls itself up, creep on a slope."""

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from harness.robots import RoverSpec
from harness.validation.rig import Rig

WHEEL_FRICTION = 1.0  # models/README.md
KERB_STEP = 1e-3  # [m]


@dataclass(frozen=True, slots=True)
class Balance:
    """Where the weight of a standing rover acts.

    Attributes:
        weight: [N].
        height: Of the centre of mass over the ground [m].
        front: Horizontal distance from the centre of mass to the front axle [m]; likewise `rear`,
            and `left`, `right` to the middle of the wheels.
    """

    weight: float
    height: float
    front: float
    rear: float
    left: float
    right: float


def balance(rig: Rig) -> Balance:
    """The balance of a rover that stands on level ground."""
    model, data = rig.simulation.model, rig.simulation.data
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    x, y, z = rig.in_model_frame(data.subtree_com[model.body("rover").id]).tolist()
    wheels = rig.in_model_frame(data.geom_xpos[rig.wheel_geoms])
    front_left, rear_left, front_right, rear_right = wheels
    return Balance(
        weight=float(model.body_mass.sum()) * rig.rover.gravity,
        height=z - float(wheels[:, 2].mean()) + rig.rover.wheel_radius,
        front=float(front_left[0] + front_right[0]) / 2 - x,
        rear=x - float(rear_left[0] + rear_right[0]) / 2,
        left=float(front_left[1] + rear_left[1]) / 2 - y,
        right=y - float(front_right[1] + rear_right[1]) / 2,
    )


def tip_angle(arm: float, height: float) -> float:
    """Incline [rad] at which the centre of mass stands above the lower wheels."""
    return math.atan2(arm, height)


def kerb_limit(rover: RoverSpec, balance: Balance) -> float:
    """Highest kerb [m] that the rear wheels climb head-on without run-up, all wheels pulling.

    The front wheels are on top, the rear ones touch the edge; both pull at the friction limit. The
    balance of moments about the front contact gives the rear normal force, that of the horizontal
    forces the limit N sin(theta) (1 + mu^2) <= mu W.
    """
    heights = np.arange(KERB_STEP, rover.wheel_radius, KERB_STEP)
    passed = [height for height in heights if _rear_wheels_climb(height, rover, balance)]
    return float(passed[-1]) if passed else 0.0


def _rear_wheels_climb(height: float, rover: RoverSpec, balance: Balance) -> bool:
    mu, radius = WHEEL_FRICTION, rover.wheel_radius
    pitch, edge = math.asin(height / rover.wheelbase), math.acos(1 - height / radius)
    lever = rover.wheelbase * math.cos(pitch) - radius * math.sin(edge)
    behind = balance.front * math.cos(pitch) + (balance.height - radius) * math.sin(pitch)
    normal = behind / (lever * (math.cos(edge) + mu * math.sin(edge)))  # over the weight
    return normal * math.sin(edge) * (1 + mu**2) <= mu
