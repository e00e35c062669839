"""One rover in a world: what its sensors, its truth and its driver read and command."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.physics import Physics
from harness.physics.scene import Scene
from harness.physics.start import settle
from harness.samples import Quaternion, Vector3
from rover_metrics.core import rotation


class Simulation:
    """One rover in one world, settled on the ground at time zero.

    Args:
        scene: The rover in its world.
        timestep_ns: Of the model.
        physics: What it shares with the world's other rovers; None for one that is alone.

    Attributes:
        physics: Steps it.
        model: The compiled scene.
        data: MuJoCo's state.
        pose: Position [m] and w, x, y, z of the model frame, a view into MuJoCo's state.
        twist: Its linear velocity [m/s] in the world and angular velocity [rad/s] in its own axes, a
            view into MuJoCo's state.
        steps_per_tick: Steps of one clock tick.
        tick_sum: MuJoCo's sensor values, each summed over the steps of the tick that is shown.
        contacts: What the rover touches in the tick that is shown.
        motors: The actuators that the controller commands, in the order of the rover's `motors`.
        crowd: The people who walk about; None without any.
        ground: What is driven on, with the ruts of now.
    """

    def __init__(self, scene: Scene, timestep_ns: int, physics: Physics | None = None) -> None:
        self.scene, self.timestep_ns = scene, timestep_ns
        self.physics = physics = Physics((scene,), timestep_ns) if physics is None else physics
        (self._rover,) = (rover for rover in physics.rovers if rover.scene is scene)
        self.model, self.data, self.crowd = physics.model, physics.data, physics.crowd
        self.ground = physics.ground
        self.pose, self.twist, self.contacts = self._rover.pose, self._rover.twist, self._rover.contacts
        self.steps_per_tick, self.tick_sum = physics.steps_per_tick, physics.tick_sum
        self.motors = self._rover.motors
        self._felt = scene.sensors()
        driven = self.motors[: len(scene.rover.drive.driven)]
        self._strongest = self.model.actuator_forcerange[driven].copy()
        self._gains = self.model.actuator_gainprm[driven, 0].copy()
        self._limited: tuple[object, ...] = (1.0, 1.0, frozenset())
        self._start = self._rover.state()

    @property
    def time_ns(self) -> int:
        """Simulation time."""
        return self.physics.time_ns

    @property
    def step_count(self) -> int:
        """Steps since time zero."""
        return self.physics.step_count

    @property
    def now(self) -> list[float]:
        """What `pose` is at the end of the tick that is shown, whether its state is shown or not."""
        return self._rover.now

    @property
    def position(self) -> Vector3:
        """Origin of the model frame in the world [m]."""
        x, y, z = self.pose[:3].tolist()
        return x, y, z

    @property
    def orientation(self) -> Quaternion:
        """Attitude of the model frame in the world, as (x, y, z, w)."""
        w, x, y, z = self.pose[3:].tolist()
        return x, y, z, w

    @property
    def yaw(self) -> float:
        """Heading of the model frame in the world [rad]."""
        return rotation.yaw(self.orientation)

    def rotation(self) -> NDArray[np.float64]:
        """Returns the rotation R_world_model of the model frame, shape (3, 3)."""
        flat = np.empty(9)
        mujoco.mju_quat2Mat(flat, self.pose[3:])
        return flat.reshape(3, 3)

    @property
    def velocity(self) -> Vector3:
        """Linear velocity of the model frame's origin in the model frame [m/s]."""
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.matrix(self.orientation)
        vx, vy, vz = self.twist[:3].tolist()  # a free joint's is in the world frame
        return (
            xx * vx + yx * vy + zx * vz,
            xy * vx + yy * vy + zy * vz,
            xz * vx + yz * vy + zz * vz,
        )

    def felt(self, sensor: str) -> NDArray[np.int64]:
        """Returns the places of the values of one sensor of the rover among MuJoCo's."""
        return np.arange(self.model.nsensordata)[self._felt[sensor]]

    def summed(self, sensor: str) -> NDArray[np.float64]:
        """Returns a view onto the entries of `tick_sum` that belong to one sensor of the rover."""
        return self.tick_sum[self._felt[sensor]]

    def command_wheels(self, commands: NDArray[np.float64]) -> None:
        """Sets the speeds [rad/s] of the driven wheels, then the angles [rad] of the steering.

        Args:
            commands: In the order of the rover's `motors`; if all speeds are 0 it is parked.
        """
        self.data.ctrl[self.motors] = commands
        self._rover.parking.hold(not any(commands[: self._rover.driven].tolist()))

    def command_ahead(self, commands: NDArray[np.float64]) -> None:
        """Commands the wheels for the ticks that `physics.run` simulates next.

        Args:
            commands: Of each tick as `command_wheels` takes them, shape (ticks, motors).
        """
        self._rover.command(commands)

    def limit_motors(self, strength: Mapping[str, float], stuck: frozenset[str]) -> None:
        """Weakens the motors of the sides and blocks wheels, from now on.

        Args:
            strength: Share of their torque, of "left" and "right".
            stuck: Joints of the wheels that do not turn.
        """
        if (now := (*strength.values(), stuck)) == self._limited:
            return
        self._limited = now
        self.physics.halt()
        drive, own = self.scene.rover.drive, self.scene.own
        for number, name in enumerate(drive.driven):
            share, motor = strength["left" if name in drive.left else "right"], self.motors[number]
            self.model.actuator_forcerange[motor] = share * self._strongest[number]
            if not self.model.actuator_forcelimited[motor]:  # what it gives is all by its gain
                gain = share * self._gains[number]
                self.model.actuator_gainprm[motor, 0], self.model.actuator_biasprm[motor, 2] = (
                    gain,
                    -gain,
                )
        self._rover.parking.block(frozenset(map(own, stuck)))

    def tick(self) -> None:
        """Advances one clock tick with all rovers, under what is commanded now, and shows its end.

        Raises:
            RunFailed: The state diverged, or a rover reached the edge of the map.
        """
        self.physics.tick()

    def return_to_start(self) -> None:
        """Puts the rover back to where and how it stood at time zero; time goes on."""
        self.physics.stay()
        self._rover.restore(self._start)
        self.physics.put_back(self._rover)
        self.command_wheels(self.data.ctrl[self.motors])
        for place in self._felt.values():
            self.tick_sum[place] = 0.0
        self.physics.contacts.begin()

    def put(self, x: float, y: float, yaw: float) -> None:
        """Puts the rover onto the ground somewhere else, where it settles; time goes on.

        Args:
            x: Position of the model frame in the world [m].
            y: Position of the model frame in the world [m].
            yaw: Its heading [rad].

        Raises:
            Diverged: It cannot stand there.
        """
        self.return_to_start()
        self._rover.velocities[:] = 0.0
        settle(self.physics, [(self._rover, (x, y, yaw))])


def simulations(scenes: Sequence[Scene], timestep_ns: int) -> tuple[Simulation, ...]:
    """Returns each rover of a world."""
    physics = Physics(scenes, timestep_ns)
    return tuple(Simulation(scene, timestep_ns, physics) for scene in scenes)
