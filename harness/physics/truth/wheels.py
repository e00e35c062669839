"""How the wheels of a rover move: where they are, how much they slip, what they do in soil."""

import math
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import kernel
from harness.physics.simulation import Simulation
from harness.samples import SoilState

SLIP_SPEED = 0.05  # [m/s]: a wheel whose rim and centre are both slower does not slip, it stands
TURNS = 0.05  # [m/s] of the rims, on average, from which on a rover wants to go on
ADVANCE = 0.1  # share of that speed below which its wheels do not get on
LASTING = 20  # states of 20 Hz, one after the other


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
        bodies: list[tuple[int, int]] = []  # of each wheel, and along whose y its axle lies
        for name in rover.wheel_joints:
            body = int(self._model.joint(scene.own(name)).bodyid[0])
            steered = name in rover.steered_wheels
            carrier = int(self._model.body_parentid[body]) if steered else scene.root
            bodies.append((body, carrier))
        self._bodies, self._rolling = np.array(bodies, np.int64), np.empty((len(bodies), 5))

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
        roll(self._bodies, data.xmat, data.xpos, data.cvel, data.subtree_com[self._root], self._rolling)
        wheels = []
        for x, y, forward, upward, turning in self._rolling.tolist():
            ground_speed = math.copysign(math.hypot(forward, upward), forward)
            wheel_speed = turning * self._radius
            moves = abs(wheel_speed) >= SLIP_SPEED or abs(ground_speed) >= SLIP_SPEED
            wheels.append(WheelMotion(x, y, slip_ratio(wheel_speed, ground_speed), moves))
        return wheels


class SoilWheels:
    """What soil does to the wheels of a simulation's rover, in the order of its wheel joints."""

    def __init__(self, simulation: Simulation) -> None:
        bed = simulation.physics.bed
        if bed is None:
            raise ValueError("rigid ground has no soil")
        self._felt = bed.felt[bed.wheels_of(simulation.scene.root)]
        self._bodies = [wheel.body for wheel in bed.wheels if wheel.root == simulation.scene.root]
        self._data = simulation.data
        self._spinning = 0

    def state(self) -> SoilState:
        """Returns the present state; to be called with each state of the truth, 20 times a second.

        A rover is stuck when its rims have turned for a second while its wheels stayed, turning on the
        spot being no standing: what counts is how fast the hubs move over the ground.
        """
        sinkage, ahead, left, _, rim, along, across, rut = self._felt.T
        hubs = np.hypot(along, across)
        turning = float(np.abs(rim).mean())
        held = turning >= TURNS and float(hubs.mean()) < ADVANCE * turning
        self._spinning = self._spinning + 1 if held else 0
        x, y, _ = self._data.xpos[self._bodies].T.tolist()
        angles = np.where(hubs < 0.1 * TURNS, 0.0, np.arctan2(across, np.abs(along)))
        return SoilState(
            sinkage=tuple(np.maximum(sinkage, 0.0).tolist()),
            slip_angle=tuple(angles.tolist()),
            pull=tuple(ahead.tolist()),
            side_force=tuple(left.tolist()),
            stuck=self._spinning >= LASTING,
            ruts=tuple(zip(x, y, np.maximum(sinkage, rut).tolist(), strict=True)),
        )

    def begin_anew(self) -> None:
        """Takes note that the rover was put elsewhere."""
        self._spinning = 0


@kernel(
    "void(int64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[::1], float64[:,::1])"
)
def roll(
    bodies: NDArray[np.int64],
    axes: NDArray[np.float64],
    positions: NDArray[np.float64],
    velocities: NDArray[np.float64],
    middle: NDArray[np.float64],
    rolling: NDArray[np.float64],
) -> None:
    """Sets of each wheel x, y [m], its centre's speed ahead and up [m/s], its turning [rad/s].

    Args:
        bodies: Of each wheel, and that along whose y its axle lies, shape (n, 2).
        axes: Rotations of all bodies in the world, shape (nbody, 9).
        positions: Their origins in the world [m], shape (nbody, 3).
        velocities: Angular and linear velocities at the centre of mass, shape (nbody, 6).
        middle: The rover's centre of mass [m], shape (3,).
        rolling: Where it comes, shape (n, 5).
    """
    for wheel in range(bodies.shape[0]):
        body, carrier = bodies[wheel, 0], axes[bodies[wheel, 1]]
        x, y, z = positions[body, 0], positions[body, 1], positions[body, 2]
        wx, wy, wz = velocities[body, 0], velocities[body, 1], velocities[body, 2]
        dx, dy, dz = x - middle[0], y - middle[1], z - middle[2]
        vx = velocities[body, 3] + wy * dz - wz * dy
        vy = velocities[body, 4] + wz * dx - wx * dz
        vz = velocities[body, 5] + wx * dy - wy * dx
        rolling[wheel, 0], rolling[wheel, 1] = x, y
        rolling[wheel, 2] = vx * carrier[0] + vy * carrier[3] + vz * carrier[6]
        rolling[wheel, 3] = vx * carrier[2] + vy * carrier[5] + vz * carrier[8]
        rolling[wheel, 4] = wx * carrier[1] + wy * carrier[4] + wz * carrier[7]


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
