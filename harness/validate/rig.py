"""A rover on a course, driven through the real controller and read through the real sensors."""

import math
from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import DEFAULT_TIMESTEP_NS, NANOSECONDS, TICK, period_ticks
from harness.physics.base_controller import base_controller
from harness.physics.scene import ROCK_CONTACT, build_scene
from harness.physics.simulation import Simulation
from harness.robots import RoverSpec
from harness.samples import Imu, Twist
from harness.sensors.state import ImuSensor
from harness.validate.grounds import Course
from harness.world.obstacles import orientation

SETTLING = 0.5  # [s] after the rover has been turned to its heading


@dataclass(frozen=True, slots=True)
class Stance:
    """Where a rover is: `ahead` along its first heading and `aside` to the left [m], yaw [rad]."""

    ahead: float
    aside: float
    yaw: float


class Rig:
    """One rover, settled, facing the heading of its course.

    Attributes:
        heading: In which it was set down [rad].
        observers: Called after every tick.
        wheel_geoms: Ids of the wheels that collide, in the order of the rover's spec.
    """

    def __init__(self, rover: RoverSpec, course: Course) -> None:
        self.rover = rover
        self.observers: list[Callable[[], None]] = []
        scene = build_scene(course.world, rover, DEFAULT_TIMESTEP_NS / NANOSECONDS)
        self.simulation = Simulation(scene, DEFAULT_TIMESTEP_NS)
        self.heading = course.heading
        self._drive = base_controller(rover, TICK)
        self._rocks = self.simulation.summed(ROCK_CONTACT)
        self.wheel_geoms = [self._wheel_geom(joint) for joint in rover.wheel_joints]
        attitude = self.simulation.data.qpos[3:7]
        mujoco.mju_mulQuat(attitude, np.array(orientation(course.heading)), attitude.copy())
        self._yaw = self.simulation.yaw
        self.run(SETTLING)

    def command(self, linear: float = 0.0, angular: float = 0.0) -> None:
        """Latches a command [m/s, rad/s]."""
        self._drive.command(Twist(linear, angular))

    def tick(self) -> None:
        """One clock tick under the command in force."""
        self.simulation.command_wheels(self._drive.wheel_speeds())
        self.simulation.tick()
        self._yaw += math.remainder(self.simulation.yaw - self._yaw, math.tau)
        for observe in self.observers:
            observe()

    def run(self, seconds: float) -> None:
        """Drives on for a simulated time [s]."""
        for _ in range(round(seconds / TICK)):
            self.tick()

    def run_until(self, done: Callable[[], bool], limit: float) -> bool:
        """Drives on until `done()` holds, for at most `limit` seconds; returns whether it does."""
        for _ in range(round(limit / TICK)):
            self.tick()
            if done():
                return True
        return False

    def imu_readings(self, rate: int, seconds: float) -> list[Imu]:
        """Drives on for a time; returns what an IMU of that rate [Hz] reads."""
        ticks = period_ticks(rate)
        imu, readings = ImuSensor(self.simulation, ticks), []

        def observe() -> None:
            imu.observe(self.simulation.tick_sum[None])

        self.observers.append(observe)
        for _ in range(round(seconds * rate)):
            self.run(ticks * TICK)
            readings.append(imu.read())
        self.observers.remove(observe)
        return readings

    @property
    def stance(self) -> Stance:
        """Where the rover is; its yaw counts full turns."""
        x, y, _ = self.simulation.position
        c, s = math.cos(self.heading), math.sin(self.heading)
        return Stance(c * x + s * y, c * y - s * x, self._yaw)

    @property
    def touches_block(self) -> bool:
        """Whether any part of the rover touched a block during the last tick."""
        return bool(self._rocks[0])

    @property
    def speed(self) -> float:
        """Speed of the model frame's origin [m/s]."""
        return float(np.linalg.norm(self.simulation.data.qvel[:3]))

    @property
    def yaw_rate(self) -> float:
        """Yaw rate about the rover's own vertical [rad/s]."""
        return float(self.simulation.data.qvel[5])

    def stands_on(self, geoms: list[int]) -> bool:
        """Returns whether one of these geoms touches anything."""
        return bool(np.isin(self.simulation.data.contact.geom, geoms).any())

    def joint_angles(self, names: tuple[str, ...]) -> NDArray[np.float64]:
        """Returns the angles of hinges [rad]."""
        return np.array([self.simulation.data.joint(name).qpos[0] for name in names])

    def in_model_frame(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns points of the world [m], shape (..., 3), in the frame of the rover's root body."""
        offset = points - self.simulation.data.qpos[:3]
        return np.asarray(offset @ self.simulation.rotation())

    def _wheel_geom(self, joint: str) -> int:
        model = self.simulation.model
        geoms = np.flatnonzero(model.geom_bodyid == model.joint(joint).bodyid[0])
        return next(int(geom) for geom in geoms if model.geom_contype[geom])


def largest_passing(passes: Callable[[float], bool], low: float, high: float, step: float) -> float:
    """Returns the largest value that passes, by bisection; NaN if none does.

    Args:
        passes: Whether a value does; if one does, so do all smaller ones.
        low: Smallest value that is tried.
        high: Largest value that is tried.
        step: Only its multiples are tried.
    """
    first, last = round(low / step), round(high / step)
    passing = bisect_left(range(first, last + 1), True, key=lambda n: not passes(n * step))
    return (first + passing - 1) * step if passing else math.nan
