"""What optional lidars and depth cameras have in common: directions, limits, readings, the sensor.

Importing this loads neither MuJoCo nor compiled kernels: options are checked before those are loaded.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from harness.sensors.corruption import RangeErrors
from harness.sensors.optional import Installation, OptionalSensor, SensorOptions
from harness.spec.value import Length, NotNegative

MOST_RAYS = 500_000  # in a reading


@dataclass(frozen=True, slots=True)
class RangeReading:
    """What an optional lidar or depth camera has read at once, in its frame."""

    stamp_ns: int
    sensor: str
    # float32, shape (n,): how often each of the directions fits between sensor and surface; of a
    # lidar the distance, of a camera the depth [m]. REP-117 coded
    ranges: NDArray[np.float32]
    # whether it was an obstacle that a ray met and not the ground, shape (n,)
    on_obstacle: NDArray[np.bool_]


class RangeOptions(SensorOptions):
    """Options of all that measure along rays.

    Attributes:
        range_min: Nearest reading [m].
        range_max: Farthest reading [m].
        noise: Its errors: white and step [m], dropout [share]; if left out those of --noise, else none.
        lost: What a lost return reads: of a lidar a miss.
    """

    lost: ClassVar[float] = math.inf
    range_min: NotNegative
    range_max: Length
    noise: RangeErrors = RangeErrors.model_construct()

    @property
    def rays(self) -> int:
        """Number of rays in a reading."""
        raise NotImplementedError

    def directions(self) -> NDArray[np.float64]:
        """Returns where rays go in the sensor's frame, each as long as a range of 1, shape (rays, 3)."""
        raise NotImplementedError

    @model_validator(mode="after")
    def _check_rays(self) -> Self:
        if self.range_min >= self.range_max:
            both = f"range_min {self.range_min:g} m and range_max {self.range_max:g} m"
            raise ValueError(f"{both} are not valid; give a higher range_max")
        if self.rays > MOST_RAYS:
            raise ValueError(f"{self.rays:,} rays a reading are not valid; give 1 to {MOST_RAYS:,}")
        return self


class RangeSensor(OptionalSensor[RangeOptions]):
    """Casts exact rays from its mount and adds its errors; the rover does not see itself."""

    sees_ground = True

    def _begin(self, installation: Installation[RangeOptions]) -> None:
        from harness.sensors.rays.bundle import RayBundle  # noqa: PLC0415 - loads kernels

        options = installation.options
        directions = options.directions()
        self._lengths = np.linalg.norm(directions, axis=1)
        unit = directions / self._lengths[:, None]
        farthest = options.range_max * float(self._lengths.max())
        self._bundle = RayBundle(installation.surroundings, unit, farthest)
        self._limits, self._rng = (options.range_min, options.range_max), installation.rng
        self._lost = options.lost
        preset = RangeErrors() if installation.noise is None else installation.noise.ranges
        self._errors = preset if options.noise == RangeErrors() else options.noise

    def read(self) -> RangeReading:
        """Returns what it sees from where the rover is now."""
        simulation = self._simulation
        distances = self._bundle.cast(simulation.data, self.pose())
        exact = (distances / self._lengths).astype(np.float32)
        ranges = self._errors.corrupt(exact, self._limits, self._rng, lost=self._lost)
        return RangeReading(simulation.time_ns, self.name, ranges, self._bundle.on_obstacle.copy())
