"""What a sensor is: something that looks at the simulation every so many clock ticks."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from harness.samples import Sample, Source

if TYPE_CHECKING:  # a process that only publishes does without MuJoCo
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from harness.physics.aside import Errand
    from harness.physics.simulation import Simulation
    from harness.physics.truth.recorder import TruthRecorder
    from harness.robots.frames.rover_frames import RoverFrames
    from harness.sensors.lidar import Lidar
    from harness.spec.ros import FrameOptions


@dataclass(frozen=True, kw_only=True, eq=False)
class EpisodeParts:
    """What the sensors of an episode are made from; a sensor whose part is None is not made."""

    simulation: "Simulation"
    lidar: "Lidar | None" = None  # the planar lidar that every rover has
    recorder: "TruthRecorder | None" = None  # knows contacts, slip and the way
    frames: "RoverFrames | None" = None
    frame_options: "FrameOptions | None" = None  # which transforms are published
    # the sensors of the episode by source; those of later rows follow
    sensors: "Mapping[Source, Sensor]" = field(default_factory=dict)
    # radius of the wheels, left and right, over the one that wheel odometry knows
    wheel_scale: tuple[float, float] = (1.0, 1.0)


class Sensor:
    """One source of samples, with `period_ticks` clock ticks between two.

    Attributes:
        sees_ground: Whether what it reads depends on the ground's present shape.
    """

    sees_ground: ClassVar[bool] = False

    def __init__(self, simulation: "Simulation", period_ticks: int) -> None:
        self._simulation = simulation
        self.period_ticks = period_ticks

    @classmethod
    def of(cls, parts: EpisodeParts, period_ticks: int) -> "Sensor | None":
        """Returns the sensor of an episode; None if the episode lacks a part that it needs."""
        return cls(parts.simulation, period_ticks)

    def due(self, tick: int) -> bool:
        """Returns whether a sample falls on a tick, counted from 1."""
        return tick % self.period_ticks == 0

    @property
    def errand(self) -> "Errand | None":
        """The part of a reading that the thread which simulates ahead can do; None for none."""
        return None

    def read(self) -> Sample:
        """Returns the reading at the simulation's present time."""
        raise NotImplementedError

    def observe(self, sums: "NDArray[np.float64]") -> None:
        """Takes clock ticks that have just been simulated into account, each once.

        Args:
            sums: MuJoCo's sensor values, summed over the steps of each of them, shape (ticks, sensors).
        """

    def before_reset(self) -> None:
        """Called when the rover is about to be put elsewhere, mostly back to its start."""

    def after_reset(self) -> None:
        """Called when the rover has been put there."""
