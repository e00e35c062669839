"""What RoboTerrain reads from Gazebo's state: model pose, true odometry, joint states."""

import numpy as np

from harness.physics.simulation import Simulation
from harness.samples import GroundTruth, JointStates, Pose, TruthState
from harness.sensors.base import Sensor
from harness.truth.recorder import TruthRecorder


class PoseSensor(Sensor):
    """Pose of the model frame in the world, as PoseConverterNode publishes it."""

    def read(self) -> Pose:
        """Returns the true pose."""
        simulation = self._simulation
        return Pose(simulation.time_ns, simulation.position, simulation.orientation)


class GroundTruthSensor(Sensor):
    """Planar true pose and body-frame velocity."""

    def read(self) -> GroundTruth:
        """Returns the truth; a free joint's angular qvel is in the model frame."""
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


class JointSensor(Sensor):
    """Joint positions, velocities and motor torques in the order of the rover's joints."""

    def __init__(self, simulation: Simulation, period_ticks: int) -> None:
        super().__init__(simulation, period_ticks)
        model, joints = simulation.model, simulation.scene.rover.joints
        self._qpos = np.array([int(model.joint(name).qposadr[0]) for name in joints])
        self._dofs = np.array([int(model.joint(name).dofadr[0]) for name in joints])

    def read(self) -> JointStates:
        """Returns positions [rad], velocities [rad/s] and efforts [N m]."""
        data = self._simulation.data
        return JointStates(
            stamp_ns=self._simulation.time_ns,
            position=tuple(data.qpos[self._qpos].tolist()),
            velocity=tuple(data.qvel[self._dofs].tolist()),
            effort=tuple(data.qfrc_actuator[self._dofs].tolist()),
        )


class TruthSensor(Sensor):
    """What only the simulator knows; nothing corrupts what it says."""

    def __init__(self, recorder: TruthRecorder, period_ticks: int) -> None:
        self._recorder, self.period_ticks = recorder, period_ticks

    def read(self) -> TruthState:
        """Returns the truth now and since the last reading."""
        return self._recorder.state()
