"""Sensors that a rover carries only if it is asked to: their options, where they sit, their base class.

The options come from an entry of `sensors:` in rover.yaml, from a preset, or from --sensors; an options
class adds fields to SensorOptions, and harness.yaml_file says what is wrong with what it is given.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.base.sim_time import period_ticks
from harness.robots import FrameRow, RoverSpec
from harness.samples import Vector3
from harness.sensors.base import Sensor
from harness.sensors.mount import Mount
from harness.sensors.noise import NoisePreset

if TYPE_CHECKING:  # whoever only publishes does without MuJoCo
    from harness.physics.simulation import Simulation

WORD = r"[A-Za-z]\w*"
LIDAR_FRAME = "lidar_link"


@dataclass(frozen=True, kw_only=True)
class SensorOptions:
    """What every optional sensor can be told; a kind adds its own fields and defaults.

    Attributes:
        name: As in --sensors and --fault; no other sensor of the rover has it.
        parent: The frame that it is mounted on; if left out, it is where the lidar is and looks ahead.
        xyz: Its place in the parent [m], or from the lidar's in the base's axes.
        rpy: Its roll, pitch and yaw there [rad], about fixed axes.
        frame: Its own frame; NAME_link if left out. Without a parent, one of the rover's frames will do.
        topic: Its topic, or what stands before the names of its topics if it has several; else its name.
        rate: Samples a second of simulation time [Hz].
        presets: Named values of some of these, which `preset: NAME` stands for, if the kind has a field
            `preset`; what is given beside it wins.
    """

    presets: ClassVar[Mapping[str, Mapping[str, object]]] = {}

    name: str
    parent: str = ""
    xyz: Vector3 = (0.0, 0.0, 0.0)
    rpy: Vector3 = (0.0, 0.0, 0.0)
    frame: str = ""
    topic: str = ""
    rate: int = 10

    @property
    def frame_id(self) -> str:
        """The frame of its messages."""
        return self.frame or f"{self.name}_link"

    def frames(self, rover: RoverSpec) -> tuple[FrameRow, ...]:
        """Returns the frames that it adds to those of a rover, the mount first."""
        return self.mount(rover, self.frame_id)

    def mount(self, rover: RoverSpec, child: str) -> tuple[FrameRow, ...]:
        """Returns the frame of its mount; none if it is one that the rover has already."""
        known = {LIDAR_FRAME, rover.imu_frame, *(row.child for row in rover.frames)}
        if not self.parent and child in known:
            return ()
        parent, (x, y, z) = self.parent or rover.odometry_child_frame, self.xyz
        if not self.parent:
            x, z = x + rover.lidar_x, z + rover.lidar_height - rover.rest_height
        return (FrameRow(parent=parent, child=child, xyz=(x, y, z), rpy=self.rpy),)

    def topic_name(self, last: str, *, alone: bool) -> str:
        """Returns the name of one of its topics.

        Args:
            last: What it is called among the sensor's own.
            alone: Whether the kind has no other.
        """
        return self.topic if self.topic and alone else f"{self.topic or self.name}/{last}"

    def check(self) -> None:
        """Checks the values together; a kind that has more to check calls this one too.

        Raises:
            UsageError: A value is not valid; the message names those that are.
        """
        if not re.fullmatch(WORD, self.name):
            raise UsageError(
                f"name '{self.name}' is not valid; give letters, digits and _, a letter first"
            )
        if self.topic and not re.fullmatch(f"{WORD}(/{WORD})*", self.topic):
            raise UsageError(
                f"topic '{self.topic}' is not valid; give e.g. front/points, no slash before it"
            )
        period_ticks(self.rate)


@dataclass(frozen=True, eq=False)
class Installation:
    """What an optional sensor of an episode is made with.

    Attributes:
        options: Of the kind's own class.
        mount: Where it is.
        rng: Its own source of randomness.
        noise: The preset of --noise; None for exact sensors. What its options say of noise wins.
    """

    options: SensorOptions
    mount: Mount
    rng: np.random.Generator
    noise: NoisePreset | None = None


class OptionalSensor(Sensor):
    """A sensor with a name, which its samples carry in their field `sensor`."""

    def __init__(self, simulation: "Simulation", installation: Installation, period_ticks: int) -> None:
        super().__init__(simulation, period_ticks)
        self.name, self._mount = installation.options.name, installation.mount

    def pose(self) -> tuple[Vector3, NDArray[np.float64]]:
        """Returns where the sensor is now: its origin [m] and R_world_sensor, shape (3, 3)."""
        from mujoco import mj_kinematics  # noqa: PLC0415 - whoever only publishes does without

        data = self._simulation.data
        mj_kinematics(self._simulation.model, data)  # poses are one step old
        pose = self._mount.pose(data)
        x, y, z = pose[0].tolist()
        return (x, y, z), pose[1:]
