"""Fixed-step MuJoCo: integer step count, health, and the raw sums that sensors and truth read.

Time is `step * timestep_ns`; a tick is the period of /clock, a whole number of steps. Nothing here
knows ROS, drivers or sample rates.
"""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.errors import Diverged, RunFailed
from harness.physics.contacts import ContactWatch
from harness.physics.crowd import Crowd
from harness.physics.parking import ParkingHold
from harness.physics.scene import Scene, motors_of
from harness.physics.start import spawn_pose
from harness.samples import Quaternion, Vector3
from harness.sim_time import NANOSECONDS, TICK_NS
from harness.world.world import EDGE_MARGIN, Start

SETTLE_LIMIT_NS = 5 * NANOSECONDS
FREE_NS = 1 * NANOSECONDS  # of that the wheels may roll; held ones would keep rockers from following
AT_REST_SPEED = 2e-3  # [m/s] and [rad/s]: below it a rover counts as settled

WHOLE_STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION)
HEALTH_WARNINGS = {
    mujoco.mjtWarning.mjWARN_BADQPOS: "position",
    mujoco.mjtWarning.mjWARN_BADQVEL: "velocity",
    mujoco.mjtWarning.mjWARN_BADQACC: "acceleration",
    mujoco.mjtWarning.mjWARN_BADCTRL: "wheel command",
}


class Simulation:
    """One rover in one world, settled on the ground at time zero.

    Args:
        scene: The rover in its world.
        timestep_ns: Of the physics [ns].
        settled: What another simulation of an equal scene has as `settled`; saves to settle anew.

    Attributes:
        model: The compiled scene.
        data: MuJoCo's state.
        step_count: Steps since time zero.
        steps_per_tick: Steps of one clock tick.
        tick_sum: MuJoCo's sensor values, each summed over the steps of the last tick.
        contacts: What the rover touched in the last tick.
        motors: The actuators that the controller commands, in the order of the rover's `motors`;
            the first `driven` of them drive.
        crowd: The people who walk about; None without any.
        settled: The state at time zero: all that the next step depends on, warm start included, so that
            it goes on bit for bit.
    """

    def __init__(
        self, scene: Scene, timestep_ns: int, settled: NDArray[np.float64] | None = None
    ) -> None:
        # Its counters are checked on every tick; the texts would go into MUJOCO_LOG.TXT in the cwd.
        mujoco.set_mju_user_warning(lambda _: None)
        self.scene = scene
        self.model = scene.model
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        self.data = mujoco.MjData(self.model)
        self._warnings = self.data.warning.number  # a view: MuJoCo counts up in it
        self.timestep_ns = timestep_ns
        self.steps_per_tick = TICK_NS // timestep_ns
        self.step_count = 0
        self.tick_sum = np.zeros(self.model.nsensordata)
        self.contacts = ContactWatch(self.model, self.data, scene.rover)
        self.motors = np.array(motors_of(self.model, scene.rover.motors))
        self.driven = len(scene.rover.drive.driven)
        self.crowd = Crowd(scene, self.data) if scene.world.people else None
        self._parking = ParkingHold(self.model, scene.rover.drive.driven)
        self._ground = scene.world.ground
        if settled is not None:
            self.settled = settled
            self.return_to_start()
        else:
            self._settle(scene.world.start)
            self.settled = np.empty(mujoco.mj_stateSize(self.model, WHOLE_STATE))
            mujoco.mj_getState(self.model, self.data, self.settled, WHOLE_STATE)

    @property
    def time_ns(self) -> int:
        """Simulation time."""
        return self.step_count * self.timestep_ns

    @property
    def position(self) -> Vector3:
        """Origin of the model frame in the world [m]."""
        x, y, z = self.data.qpos[:3].tolist()
        return x, y, z

    @property
    def orientation(self) -> Quaternion:
        """Attitude of the model frame in the world, as (x, y, z, w)."""
        w, x, y, z = self.data.qpos[3:7].tolist()
        return x, y, z, w

    @property
    def yaw(self) -> float:
        """Heading of the model frame in the world [rad]."""
        x, y, z, w = self.orientation
        return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))

    def rotation(self) -> NDArray[np.float64]:
        """Returns the rotation R_world_model of the model frame, shape (3, 3)."""
        flat = np.empty(9)
        mujoco.mju_quat2Mat(flat, self.data.qpos[3:7])
        return flat.reshape(3, 3)

    @property
    def velocity(self) -> Vector3:
        """Linear velocity of the model frame's origin in the model frame [m/s]."""
        w, x, y, z = self.data.qpos[3:7].tolist()
        vx, vy, vz = self.data.qvel[:3].tolist()  # a free joint's is in the world frame
        return (
            (1 - 2 * (y * y + z * z)) * vx + 2 * (x * y + w * z) * vy + 2 * (x * z - w * y) * vz,
            2 * (x * y - w * z) * vx + (1 - 2 * (x * x + z * z)) * vy + 2 * (y * z + w * x) * vz,
            2 * (x * z + w * y) * vx + 2 * (y * z - w * x) * vy + (1 - 2 * (x * x + y * y)) * vz,
        )

    def summed(self, sensor: str) -> NDArray[np.float64]:
        """Returns a view onto the entries of `tick_sum` that belong to one sensor of the model."""
        found = self.model.sensor(sensor)
        start, size = int(found.adr[0]), int(found.dim[0])
        return self.tick_sum[start : start + size]

    def command_wheels(self, commands: NDArray[np.float64]) -> None:
        """Sets the speeds [rad/s] of the driven wheels, then the angles [rad] of the steering.

        Args:
            commands: In the order of the rover's `motors`; if all speeds are 0 it is parked.
        """
        self.data.ctrl[self.motors] = commands
        self._parking.hold(not any(commands[: self.driven].tolist()))

    def tick(self) -> None:
        """Advances one clock tick; `tick_sum` then holds the sensor values summed over its steps.

        Raises:
            RunFailed: The state diverged, or the rover reached the edge of the map.
        """
        model, data, total = self.model, self.data, self.tick_sum
        contacts, counts = self.contacts, self.contacts.counts
        total.fill(0.0)
        contacts.begin()
        if self.crowd is not None:
            self.crowd.move(self.time_ns + TICK_NS)
        for _ in range(self.steps_per_tick):
            mujoco.mj_step(model, data)
            total += data.sensordata
            if any(counts.tolist()):
                contacts.look()
        if self.crowd is not None:
            self.crowd.look(contacts)
        self.step_count += self.steps_per_tick
        self.check()

    def check(self) -> None:
        """Checks the present state.

        Raises:
            RunFailed: It diverged, or the rover reached the edge of the map.
        """
        self._check_health()
        self._check_edge()

    def return_to_start(self) -> None:
        """Puts the rover back to where and how it stood at time zero; time goes on."""
        mujoco.mj_setState(self.model, self.data, self.settled, WHOLE_STATE)
        self.command_wheels(self.data.ctrl[self.motors])
        self.tick_sum.fill(0.0)
        self.contacts.begin()

    def put(self, x: float, y: float, yaw: float) -> None:
        """Puts the rover onto the ground somewhere else, where it settles; time goes on.

        Args:
            x: Position of the model frame in the world [m]; likewise `y`.
            y: See `x`.
            yaw: Its heading [rad].

        Raises:
            Diverged: It cannot stand there.
        """
        self.return_to_start()
        self.data.qvel[:] = 0.0
        self._settle((x, y, yaw))

    def _check_health(self) -> None:
        if not any(self._warnings.tolist()):  # a third of the time of numpy's any
            return
        for warning, quantity in HEALTH_WARNINGS.items():
            if self.data.warning[warning].number:
                raise Diverged(
                    f"the simulation diverged at t = {self.time_ns / NANOSECONDS:.2f} s "
                    f"(NaN, infinite or huge {quantity}); position {_rounded(self.data.qpos[:3])} m, "
                    f"velocity {_rounded(self.data.qvel[:3])} m/s; try a smaller --timestep"
                )

    def _check_edge(self) -> None:
        x, y = self.data.qpos[:2].tolist()
        if not self._ground.contains(x, y, EDGE_MARGIN):
            raise RunFailed(
                f"the rover reached the edge of the map at t = {self.time_ns / NANOSECONDS:.2f} s "
                f"(x = {x:.2f} m, y = {y:.2f} m)"
            )

    def _settle(self, start: Start) -> None:
        """Lets the rover down onto the ground, so that no drop pollutes the first samples."""
        self.data.qpos[:7] = spawn_pose(self.scene, start)
        for tick in range(SETTLE_LIMIT_NS // TICK_NS):
            self._parking.hold(tick >= FREE_NS // TICK_NS)
            for _ in range(self.steps_per_tick):
                mujoco.mj_step(self.model, self.data)
            self._check_health()
            if np.abs(self.data.qvel).max() < AT_REST_SPEED and self.data.ncon:
                break
        self._parking.hold(True)
        self.data.time = 0.0


def _rounded(values: NDArray[np.float64]) -> list[float]:
    return [round(float(v), 3) for v in values]
