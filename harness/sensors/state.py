"""Sensors without options: pose, IMU, lidar, true odometry, joint states, truth, people."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import HIGHEST_RATE
from harness.physics.aside import Errand
from harness.physics.crowd import Crowd
from harness.physics.simulation import Simulation
from harness.physics.truth.recorder import TruthRecorder
from harness.samples import ActorPoses, GroundTruth, Imu, JointStates, LaserScan, Pose, TruthState
from harness.sensors.base import EpisodeParts, Sensor
from harness.sensors.lidar import Lidar

PEOPLE_RATE = 30  # [Hz]


class PoseSensor(Sensor):
    """Pose of the model frame in the world, as PoseConverterNode publishes it."""

    def read(self) -> Pose:
        """Returns the true pose."""
        simulation = self._simulation
        return Pose(simulation.time_ns, simulation.position, simulation.orientation)


class ImuSensor(Sensor):
    """Specific force and angular rate, averaged over every step of the sample's window.

    A single step would alias the contacts' high frequencies into the reading; a real sensor filters them
    (facts: models/README.md). The frame is that of the site `imu`.
    """

    def __init__(self, simulation: Simulation, period_ticks: int) -> None:
        super().__init__(simulation, period_ticks)
        self._steps = 0  # in the window so far
        force, rate = (simulation.felt(name) for name in ("imu_accelerometer", "imu_gyro"))
        self._felt = np.r_[force, rate]
        self._sum = [0.0] * 6
        self._mounting = simulation.model.site(simulation.scene.own("imu")).quat.copy()
        self._attitude = np.empty(4)

    def observe(self, sums: NDArray[np.float64]) -> None:
        """Adds ticks that have just been simulated to the window, one after the other."""
        fx, fy, fz, wx, wy, wz = self._sum
        for dfx, dfy, dfz, dwx, dwy, dwz in sums[:, self._felt].tolist():  # faster than small arrays
            fx, fy, fz = fx + dfx, fy + dfy, fz + dfz
            wx, wy, wz = wx + dwx, wy + dwy, wz + dwz
        self._sum = [fx, fy, fz, wx, wy, wz]
        self._steps += self._simulation.steps_per_tick * len(sums)

    def read(self) -> Imu:
        """Returns the window's means [m/s^2, rad/s] and the attitude at its end; starts a new window."""
        mujoco.mju_mulQuat(self._attitude, self._simulation.pose[3:], self._mounting)
        w, x, y, z = self._attitude.tolist()
        fx, fy, fz, wx, wy, wz = (total / self._steps for total in self._sum)
        reading = Imu(self._simulation.time_ns, (x, y, z, w), (wx, wy, wz), (fx, fy, fz))
        self.after_reset()
        return reading

    def after_reset(self) -> None:
        """Starts a new window; what is in the present one is never read."""
        self._sum = [0.0] * 6
        self._steps = 0


class LidarSensor(Sensor):
    """The lidar as a sensor of the episode.

    Args:
        simulation: Of the rover.
        lidar: Casts the rays.
        period_ticks: Clock ticks between two scans.
    """

    sees_ground = True

    def __init__(self, simulation: Simulation, lidar: Lidar, period_ticks: int) -> None:
        super().__init__(simulation, period_ticks)
        self._lidar = lidar
        self._aside: Errand | None = None
        self._distances = np.empty(0)  # of what it has scanned

    @classmethod
    def of(cls, parts: EpisodeParts, period_ticks: int) -> "LidarSensor | None":
        """Returns the lidar of an episode; None without one."""
        return None if parts.lidar is None else cls(parts.simulation, parts.lidar, period_ticks)

    @property
    def errand(self) -> Errand | None:
        """The scan; None where meshes may be met."""
        if self._aside is None and not self._lidar.surroundings.has_meshes:
            self._aside, self._distances = self._lidar.aside(self._simulation.model)
        return self._aside

    def read(self) -> LaserScan:
        """Returns a scan from where the rover is now."""
        simulation, aside = self._simulation, self._aside
        if aside is not None and aside.is_done:
            aside.is_done = False
            return LaserScan(simulation.time_ns, self._lidar.coded(self._distances))
        return LaserScan(simulation.time_ns, self._lidar.scan(simulation.data))


class GroundTruthSensor(Sensor):
    """Planar true pose and body-frame velocity."""

    def read(self) -> GroundTruth:
        """Returns the truth; a free joint's angular qvel is in the model frame."""
        simulation = self._simulation
        x, y, _ = simulation.position
        wx, wy, wz = simulation.twist[3:].tolist()
        turning = wx, wy, wz
        return GroundTruth(simulation.time_ns, x, y, simulation.yaw, simulation.velocity, turning)


class JointSensor(Sensor):
    """Joint positions, velocities and motor torques in the order of the rover's joints."""

    def __init__(self, simulation: Simulation, period_ticks: int) -> None:
        super().__init__(simulation, period_ticks)
        scene = simulation.scene
        joints = [simulation.model.joint(name) for name in scene.all_own(scene.rover.joints)]
        data, dofs = simulation.data, np.array([int(joint.dofadr[0]) for joint in joints])
        angles = np.array([int(joint.qposadr[0]) for joint in joints])
        self._values = (data.qpos, angles), (data.qvel, dofs), (data.qfrc_actuator, dofs)

    def read(self) -> JointStates:
        """Returns positions [rad], velocities [rad/s] and efforts [N m]."""
        values = [tuple(array[places].tolist()) for array, places in self._values]
        return JointStates(self._simulation.time_ns, *values)


class TruthSensor(Sensor):
    """What only the simulator knows; nothing corrupts what it says."""

    def __init__(self, recorder: TruthRecorder, period_ticks: int) -> None:
        self._recorder, self.period_ticks = recorder, period_ticks

    @classmethod
    def of(cls, parts: EpisodeParts, period_ticks: int) -> "TruthSensor | None":
        """Returns the truth of an episode; None without a recorder."""
        return None if parts.recorder is None else cls(parts.recorder, period_ticks)

    def read(self) -> TruthState:
        """Returns the truth now and since the last reading."""
        return self._recorder.state()


class PeopleSensor(Sensor):
    """Positions and headings of everybody in a crowd, 30 times a second as RoboTerrain's plugin.

    30 Hz do not divide the clock's 100: of each 10 ticks the 4th, the 7th and the 10th have a sample,
    that is each tick by which another thirtieth of a second is full: 40, 30 and 30 ms apart.
    """

    def __init__(self, simulation: Simulation, crowd: Crowd) -> None:
        super().__init__(simulation, HIGHEST_RATE // PEOPLE_RATE)
        self._crowd = crowd

    def due(self, tick: int) -> bool:
        """Returns whether a sample falls on a tick, counted from 1."""
        return tick * PEOPLE_RATE // HIGHEST_RATE > (tick - 1) * PEOPLE_RATE // HIGHEST_RATE

    def read(self) -> ActorPoses:
        """Returns where everybody is."""
        crowd = self._crowd
        halves = [place.yaw / 2 for place in crowd.places]
        turned = tuple((0.0, 0.0, math.sin(half), math.cos(half)) for half in halves)
        return ActorPoses(self._simulation.time_ns, tuple(crowd.positions()), turned)
