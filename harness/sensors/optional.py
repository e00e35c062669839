"""Sensors that a rover carries only if it is asked to: their options, where they sit, their base class.

The options come from an entry of `sensors:` in rover.yaml, from a preset, or from --sensors. An options
class adds fields to SensorOptions; harness.spec.value.made says what is wrong with what it is given.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, ConfigDict

from harness.base.errors import UsageError
from harness.base.sim_time import period_ticks
from harness.robots import RoverSpec
from harness.robots.sections import Angles, FrameRow, Vector
from harness.sensors.base import Sensor
from harness.sensors.noise import NoisePreset
from harness.spec.value import Value, checked
from harness.world.geodesy import Datum

if TYPE_CHECKING:  # a process that only publishes does without MuJoCo
    from harness.physics.simulation import Simulation
    from harness.robots.frames.rover_frames import BodyFrame
    from harness.sensors.rays.bundle import Surroundings

WORD = r"[A-Za-z][A-Za-z0-9_]*"
OF_TOPIC = re.compile(f"{WORD}(/{WORD})*")
Rate = Annotated[int, AfterValidator(checked(period_ticks))]  # [Hz], whole ticks of the clock apart


def _check_name(name: str) -> None:
    if not re.fullmatch(WORD, name):
        raise UsageError(f"name '{name}' is not valid; give letters, digits and _, a letter first")


def _check_topic(topic: str) -> None:
    if topic and not OF_TOPIC.fullmatch(topic):
        raise UsageError(f"topic '{topic}' is not valid; give e.g. front/points, no slash before it")


class SensorOptions(Value):
    """Options that every optional sensor has; a kind adds its own fields and defaults.

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

    model_config = ConfigDict(allow_inf_nan=False)
    presets: ClassVar[Mapping[str, Mapping[str, object]]] = {}

    name: Annotated[str, AfterValidator(checked(_check_name))]
    parent: str = ""
    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Angles = (0.0, 0.0, 0.0)
    frame: str = ""
    topic: Annotated[str, AfterValidator(checked(_check_topic))] = ""
    rate: Rate = 10

    @property
    def frame_id(self) -> str:
        """The frame of its messages."""
        return self.frame or f"{self.name}_link"

    def check(self, rover: RoverSpec) -> None:
        """Checks that a rover can carry it; UsageError if not."""

    def frames(self, rover: RoverSpec) -> tuple[FrameRow, ...]:
        """Returns the frames that it adds to those of a rover, the mount first."""
        return self.mount(rover, self.frame_id)

    def mount(self, rover: RoverSpec, child: str) -> tuple[FrameRow, ...]:
        """Returns the frame of its mount; none if it is one that the rover has already."""
        known = {rover.lidar_frame, rover.imu_frame, *(row.child for row in rover.frames)}
        if self.parent:
            return (FrameRow(parent=self.parent, child=child, xyz=self.xyz, rpy=self.rpy),)
        if child in known:
            return ()
        (x, y, z), base = self.xyz, rover.odometry_child_frame
        xyz = x + rover.lidar_x, y + rover.lidar_y, z + rover.lidar_z
        return (FrameRow(parent=base, child=child, xyz=xyz, rpy=self.rpy),)

    def topic_name(self, last: str, *, alone: bool) -> str:
        """Returns the name of the topic that ends so, or that is alone."""
        return self.topic if self.topic and alone else f"{self.topic or self.name}/{last}"


Given = TypeVar("Given", bound=SensorOptions, covariant=True)  # noqa: PLC0105 - the class that it is


@dataclass(frozen=True, eq=False)
class Installation(Generic[Given]):
    """What an optional sensor of an episode is made with."""

    options: Given
    mount: "BodyFrame"
    rng: np.random.Generator  # its own source of randomness
    datum: Datum  # the origin of the world on the Earth
    surroundings: "Surroundings"  # what its rays can meet
    # the preset of --noise; None for exact sensors. What its options say of noise wins
    noise: NoisePreset | None = None


class OptionalSensor(Sensor, Generic[Given]):
    """A sensor with a name, which its samples carry in their field `sensor`.

    Args:
        simulation: Of the rover.
        installation: Its options, its mount, its noise and its randomness.
        period_ticks: Clock ticks between two samples.
    """

    def __init__(
        self, simulation: "Simulation", installation: Installation[Given], period_ticks: int
    ) -> None:
        super().__init__(simulation, period_ticks)
        self.name, self._mount = installation.options.name, installation.mount
        self._begin(installation)

    def _begin(self, installation: Installation[Given]) -> None:
        """Takes what its kind needs of the installation, beside name and mount."""

    def pose(self) -> NDArray[np.float64]:
        """Returns where the sensor is now: its origin [m] and below it R_world_sensor, shape (4, 3)."""
        from mujoco import mj_kinematics  # noqa: PLC0415 - not to publish

        mj_kinematics(self._simulation.model, self._simulation.data)  # poses are one step old
        return self._mount.pose(self._simulation.data)
