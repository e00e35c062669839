"""What RoboTerrain reads from Gazebo's state: model pose, true odometry, joint states."""

import numpy as np

from harness.physics.simulation import Simulation
from harness.samples import GroundTruth, JointStates, Pose, TruthState
from harness.truth.recorder import TruthRecorder

TRUTH_RATE = 20  # [Hz]


class PoseSensor:
    """Pose of the model frame in the world, as PoseConverterNode publishes it."""

    def __init__(self, simulation: Simulation, period_ticks: int) -> None:
        self.period_ticks = period_ticks
        self._simulation = simulation

    def read(self) -> Pose:
        """The true pose."""
        simulation = self._simulation
        return Pose(simulation.time_ns, simulation.position, simulation.orientation)


class GroundTruthSensor:
    """Planar true pose and body-frame velocity."""

    def __init__(self, simulation: Simulation, period_ticks: int) -> None:
        self.period_ticks = period_ticks
        self._simulation = simulation

    def read(self) -> GroundTruth:
        """The truth; a free joint's angular qvel is in the model frame."""
        simulation = self._simulation
        x, y, _ = simulation.position
        wx, wy, wz = simulation.data.qvel[3:6].tolist()
        return GroundTruth(
            stamp_ns=simulation.time_ns,
            x=x,
            y=y,
            yaw=simulation.yaw,
            linear_velocity=simulation.velocity,
            angular_velocity=(wx, wy, wz),
        )


class JointSensor:
    """Joint positions, velocities and motor torques in the order of the rover's joints."""

    def __init__(self, simulation: Simulation, period_ticks: int) -> None:
        self.period_ticks = period_ticks
        self._simulation = simulation
        model, joints = simulation.model, simulation.scene.rover.joints
        self._qpos = np.array([int(model.joint(name).qposadr[0]) for name in joints])
        self._dofs = np.array([int(model.joint(name).dofadr[0]) for name in joints])

    def read(self) -> JointStates:
        """Positions [rad], velocities [rad/s] and efforts [N m]."""
        data = self._simulation.data
        return JointStates(
            stamp_ns=self._simulation.time_ns,
            position=tuple(data.qpos[self._qpos].tolist()),
            velocity=tuple(data.qvel[self._dofs].tolist()),
            effort=tuple(data.qfrc_actuator[self._dofs].tolist()),
        )


class TruthSensor:
    """Reads a recorder; nothing corrupts what it says."""

    def __init__(self, recorder: TruthRecorder, period_ticks: int) -> None:
        self.period_ticks = period_ticks
        self._recorder = recorder

    def read(self) -> TruthState:
        """The truth now and since the last reading."""
        return self._recorder.state()
