"""The drive of the oracle once more, by nothing but MuJoCo: the raw states that all is computed from.

The model is the harness's; letting the rover down, commands, steps and the way back are written here
from their specification. MuJoCo is deterministic, so the twin's states are those of the run.
"""

import copy
import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.physics.scene import build_scene
from harness.robots import RoverSpec
from harness.samples import Twist
from harness.world.world import World

TIMESTEP, STEPS_PER_TICK, TICK_NS = 0.0025, 4, 10_000_000
TICK = 0.01  # [s]

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Step:
    """What MuJoCo computed in one step, of the state in which the step began.

    Attributes:
        touched: Kinds of contact ("hazard", "rock", "scrape") and their normal forces [N].
    """

    qpos: Values
    qvel: Values
    qacc: Values
    ctrl: Values
    touched: tuple[tuple[str, float], ...]


class Twin:
    """A rover on the stage; wheels are in the order front left, rear left, front right, rear right.

    Attributes:
        steps: All steps since the start.
        path_length: Of the rover's origin, from tick to tick, without the way back [m].
        began_ns: When the drive began, or the rover was put back.
        carried: Angles by which the wheels were turned when the rover was put back [encoder counts].
    """

    def __init__(self, rover: RoverSpec, world: World) -> None:
        self.rover, self.world = rover, world
        self.model = build_scene(world, rover, TIMESTEP).model
        self.data, self._present = mujoco.MjData(self.model), mujoco.MjData(self.model)
        self.time_ns = self.began_ns = 0
        self.steps: list[Step] = []
        self.path_length = 0.0
        self._twist = np.zeros(2)  # ramped, as the controller has it
        self.wheels = [self.model.joint(name) for name in rover.wheel_joints]
        self._wheel_bodies = {int(wheel.bodyid[0]) for wheel in self.wheels}
        self.carried = np.zeros(4)
        self._dofs = [int(wheel.dofadr[0]) for wheel in self.wheels]
        self._driving = (1.0, self.model.dof_frictionloss[self._dofs], self.model.dof_solimp[self._dofs])
        self._let_down()
        self._hold(parked=True)
        self.counts_at_start = self.encoder_counts()
        self._start = copy.copy(self.data)
        self.restless = float(np.abs(self.data.qvel).max())

    def _let_down(self) -> None:
        """From 1 cm above the highest ground below, until it rests, at most 5 s; parked after 1 s."""
        x0, x1, y0, y1 = self.rover.footprint
        grid = self.world.ground.cell / 2
        under = [(x, y) for x in np.arange(x0, x1, grid) for y in np.arange(y0, y1, grid)]
        highest = max(self.world.ground.height_at(x, y) for x, y in under)
        self.data.qpos[2] = highest + self.rover.rest_height + 0.01
        for tick in range(500):
            self._hold(parked=tick >= 100)
            mujoco.mj_step(self.model, self.data, STEPS_PER_TICK)
            if self.data.ncon and np.abs(self.data.qvel).max() < 2e-3:
                return

    def _hold(self, *, parked: bool) -> None:
        """Parked, friction is 30 times as stiff and the motors' torque is dry friction, nearly rigid."""
        impratio, friction, solimp = self._driving
        if parked:
            motors = [self.model.actuator(wheel.name) for wheel in self.wheels]
            friction = friction + [motor.forcerange[1] for motor in motors]
            impratio, solimp = 30.0, np.array([0.9999, 0.9999, 0.001, 0.5, 2.0])
        self.model.opt.impratio = impratio
        self.model.dof_frictionloss[self._dofs] = friction
        self.model.dof_solimp[self._dofs] = solimp

    def put_back(self) -> None:
        """To the start, standing as then."""
        before = self.encoder_counts()
        self.data = copy.copy(self._start)
        self._twist = np.zeros(2)
        self.began_ns = self.time_ns
        self.carried += before - self.encoder_counts()

    def tick(self, command: Twist) -> None:
        """10 ms under a command: acceleration limits, inverse kinematics of a skid steer, steps."""
        rover = self.rover
        limits = np.array([rover.linear_acceleration, rover.angular_acceleration]) * TICK
        wanted = np.array([command.linear, command.angular]) - self._twist
        self._twist += np.clip(wanted, -limits, limits)
        linear, angular = self._twist
        sides = linear + np.array([-1.0, -1.0, 1.0, 1.0]) * angular * rover.controller_separation / 2
        for wheel, speed in zip(self.wheels, sides / rover.controller_radius, strict=True):
            self.data.actuator(wheel.name).ctrl[0] = speed
        self._hold(parked=not sides.any())
        before = self.data.qpos[:3].copy()
        for _ in range(STEPS_PER_TICK):
            self._step()
        self.path_length += float(np.linalg.norm(self.data.qpos[:3] - before))
        self.time_ns += TICK_NS

    def _step(self) -> None:
        data = self.data
        qpos, qvel, ctrl = data.qpos.copy(), data.qvel.copy(), data.ctrl.copy()
        mujoco.mj_step(self.model, data)
        self.steps.append(Step(qpos, qvel, data.qacc.copy(), ctrl, self._touched()))

    def _touched(self) -> tuple[tuple[str, float], ...]:
        touched, force = [], np.zeros(6)
        for index, geoms in enumerate(self.data.contact.geom):
            bodies = [int(self.model.geom_bodyid[geom]) for geom in geoms]
            names = [self.model.body(body).name for body in bodies]
            kind = next((k for k in ("hazard", "rock") if f"{k}s" in names), "scrape")
            if kind == "scrape" and self._wheel_bodies & set(bodies):
                continue  # a wheel on the ground
            mujoco.mj_contactForce(self.model, self.data, index, force)
            touched.append((kind, float(force[0])))
        return tuple(touched)

    @property
    def attitude(self) -> Rotation:
        """R_world_rover."""
        return attitude(self.data.qpos)

    def encoder_counts(self) -> Values:
        """Whole counts of each wheel, rounded down."""
        angles = np.array([self.data.joint(wheel.name).qpos[0] for wheel in self.wheels])
        return np.floor(angles * self.rover.encoder_ticks / math.tau)

    def at_present(self) -> mujoco.MjData:
        """The present state with what follows from it: poses and Jacobians; a step leaves older ones."""
        self._present.qpos[:], self._present.qvel[:] = self.data.qpos, self.data.qvel
        self._present.mocap_pos[0] = self.person
        mujoco.mj_fwdPosition(self.model, self._present)
        return self._present

    @property
    def person(self) -> Values:
        """Middle of the one who walks 1 m/s along -y from (-2, 1.5), anew when the rover is put back."""
        x, y = -2.0, 1.5 - (self.time_ns - self.began_ns) / 1e9
        return np.array([x, y, self.world.ground.height_at(x, y) + 1.75 / 2])


def attitude(qpos: Values) -> Rotation:
    """R_world_rover of a state, or of many; MuJoCo writes w first, scipy last."""
    return Rotation.from_quat(qpos[..., [4, 5, 6, 3]])
