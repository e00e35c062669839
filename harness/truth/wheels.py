"""How the wheels of a rover move over the ground: where they are and how much they slip."""

import math
from typing import NamedTuple

import mujoco

from harness.physics.simulation import Simulation

SLIP_SPEED = 0.05  # [m/s]: a wheel whose rim and centre are both slower does not slip, it stands


class WheelMotion(NamedTuple):
    """One wheel at one instant."""

    x: float  # position of its centre in the world [m]
    y: float  # position of its centre in the world [m]
    slip: float  # slip ratio, -1..1
    moves: bool  # whether its rim or its centre is faster than what counts as standing


class Wheels:
    """The wheels of a simulation's rover, in the order of its wheel joints.

    Axles lie along the rover's y; those of steered wheels along that of the body that turns them.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._model, self._data = simulation.model, simulation.data
        scene = simulation.scene
        rover, self._root = scene.rover, scene.root
        self._radius = rover.wheel_radius
        self._bodies: list[tuple[int, int]] = []  # of each wheel, and along whose y its axle lies
        for name in rover.wheel_joints:
            body = int(self._model.joint(scene.own(name)).bodyid[0])
            steered = name in rover.steered_wheels
            carrier = int(self._model.body_parentid[body]) if steered else scene.root
            self._bodies.append((body, carrier))

    def motion(self) -> list[WheelMotion]:
        """Returns what each wheel does now.

        A wheel's ground speed is that of its centre in its plane, which for a wheel that rolls is w r
        on any shape of ground; negative backwards. w is its whole angular velocity about the axle, the
        rover's own pitching included.
        """
        model, data = self._model, self._data
        mujoco.mj_kinematics(model, data)  # after a step, poses and velocities are those before it
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        axes = data.xmat.tolist()
        com_x, com_y, com_z = data.subtree_com[self._root].tolist()
        positions, velocities = data.xpos.tolist(), data.cvel.tolist()
        wheels = []
        for body, carrier in self._bodies:
            ahead_x, axle_x, up_x, ahead_y, axle_y, up_y, ahead_z, axle_z, up_z = axes[carrier]
            x, y, z = positions[body]
            wx, wy, wz, vx, vy, vz = velocities[body]  # of the point that is at the centre of mass
            dx, dy, dz = x - com_x, y - com_y, z - com_z
            vx, vy, vz = vx + wy * dz - wz * dy, vy + wz * dx - wx * dz, vz + wx * dy - wy * dx
            forward = vx * ahead_x + vy * ahead_y + vz * ahead_z
            upward = vx * up_x + vy * up_y + vz * up_z
            ground_speed = math.copysign(math.hypot(forward, upward), forward)
            wheel_speed = (wx * axle_x + wy * axle_y + wz * axle_z) * self._radius
            moves = abs(wheel_speed) >= SLIP_SPEED or abs(ground_speed) >= SLIP_SPEED
            wheels.append(WheelMotion(x, y, slip_ratio(wheel_speed, ground_speed), moves))
        return wheels


def slip_ratio(wheel_speed: float, ground_speed: float) -> float:
    """Returns the longitudinal slip in -1..1: positive when driving, negative when braking, 0 at rest.

    (w r - v) / max(|w r|, |v|), the two-sided form of Wong, Theory of Ground Vehicles, section 1.3; a
    wheel that turns against its motion slips fully, it cannot do more.

    Args:
        wheel_speed: Circumferential speed of the wheel [m/s].
        ground_speed: Speed of the wheel's centre along its heading [m/s].
    """
    reference = max(abs(wheel_speed), abs(ground_speed))
    if reference < SLIP_SPEED:
        return 0.0
    return max(-1.0, min(1.0, (wheel_speed - ground_speed) / reference))
