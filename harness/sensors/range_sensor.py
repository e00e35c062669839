"""The sensor behind optional lidars and depth cameras: exact rays from its mount, then its errors."""

import numpy as np

from harness.physics.simulation import Simulation
from harness.sensors.corruption import RangeErrors
from harness.sensors.optional import Installation, OptionalSensor
from harness.sensors.ranging import RangeOptions, RangeReading
from harness.sensors.rays.bundle import RayBundle


class RangeSensor(OptionalSensor[RangeOptions]):
    """Casts the rays of its options; the rover does not see itself."""

    sees_ground = True

    def __init__(
        self, simulation: Simulation, installation: Installation[RangeOptions], period_ticks: int
    ) -> None:
        super().__init__(simulation, installation, period_ticks)
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
