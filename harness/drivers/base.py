"""What a driver is: from what the rover can know to a twist, once per control period."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.samples import Sample, Twist
from harness.world.obstacles import Obstacle


@dataclass(frozen=True, slots=True)
class Observation:
    """What a driver may use.

    Attributes:
        time_ns: Simulation time since the drive began, at the start or at a reset.
        x: Position [m] in the world, as a localisation would tell; likewise `y`.
        yaw: Heading [rad].
        ranges: The last scan, shape (beams,), or None before the first.
        readings: The last sample of each kind that is read.
        touches_hazard: What a bumper all around the rover would tell; for staged encounters.
    """

    time_ns: int
    x: float
    y: float
    yaw: float
    ranges: NDArray[np.float32] | None
    touches_hazard: bool = False
    readings: Mapping[type[Sample], Sample] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class DriverContext:
    """What a driver is made for.

    Attributes:
        rover: The rover to drive.
        half_size: Half the lengths of the map along x and y, or of what of it can be driven [m].
        bearings: Direction [rad] of each lidar beam in the rover's frame, 0 ahead, left positive.
        rng: The driver's own source of randomness.
        command_timeout_ns: After which a command of /cmd_vel ends; None for never.
        obstacles: What stands in the world; only a driver that stages encounters may look.
        middle: Of the map, in the world: x, y [m].
    """

    rover: RoverSpec
    half_size: tuple[float, float]
    bearings: NDArray[np.float64]
    rng: np.random.Generator
    obstacles: tuple[Obstacle, ...] = ()
    command_timeout_ns: int | None = None
    middle: tuple[float, float] = (0.0, 0.0)


class Driver(Protocol):
    """Chooses the command; made from a `DriverContext`."""

    summary: ClassVar[str]
    senses: ClassVar[frozenset[type[Sample]]]  # the samples that it looks at

    def __init__(self, context: DriverContext) -> None: ...

    def command(self, observation: Observation) -> Twist:
        """Returns the twist for the next control period."""
        ...
