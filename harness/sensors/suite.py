"""The sensors that a rover carries: which are due at a tick, what they read, what noise makes of it."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from weakref import WeakValueDictionary

from harness.base.sim_time import HIGHEST_RATE, TICKS_PER_CONTROL
from harness.physics.aside import Errand
from harness.robots import RoverSpec
from harness.samples import Sample, Source, source
from harness.sensors.base import EpisodeParts, Sensor
from harness.sensors.choice import chosen
from harness.sensors.noise import SensorNoise
from harness.sensors.row import Install, SensorRow
from rover_metrics.plugins import misfit


class SensorSuite:
    """The sensors of one rover; call `tick` after every clock tick, in their order.

    Args:
        parts: What sensors may be made from.
        rover: Whose rates they have.
        rates: Other rates, by sample [Hz].
        wanted: Which samples; None for all that the parts suffice for.
        noise: What corrupts their readings; None for nothing.
        rows: The sensors; None for those of every rover.
        install: Installs optional ones; None where there are none.

    Attributes:
        latest: The last sample of each kind.
        sees_ground_between: Whether a sensor sees the ground's shape within a control period.
    """

    def __init__(
        self,
        parts: EpisodeParts,
        rover: RoverSpec,
        rates: Mapping[type[Sample], int],
        *,
        wanted: Collection[type[Sample]] | None = None,
        noise: SensorNoise | None = None,
        rows: Iterable[SensorRow] | None = None,
        install: Install | None = None,
    ) -> None:
        made: WeakValueDictionary[Source, Sensor] = WeakValueDictionary()  # one may know all, so itself
        self._kinds: dict[Sensor, type[Sample]] = {}
        self._sources: dict[Sensor, Source] = {}
        scale = (1.0, 1.0) if noise is None else noise.wheel_scale
        parts = replace(parts, sensors=made, wheel_scale=scale)
        for row in chosen(rover, ()) if rows is None else rows:
            if wanted is None or row.source in wanted:
                sensor = row.make(parts, rates.get(row.sample, row.rate_on(rover)), install)
                if sensor is not None:
                    made[row.source] = sensor
                    self._kinds[sensor], self._sources[sensor] = row.sample, row.source
        self._sensors = tuple(self._kinds)
        # Periods divide a second: what is due in one is due in each.
        self._due = [[s for s in self._sensors if s.due(n or HIGHEST_RATE)] for n in range(HIGHEST_RATE)]
        self._observe = [sensor.observe for sensor in self._sensors if observes(sensor)]
        seeing = (s.period_ticks for s in self._sensors if s.sees_ground)
        self.sees_ground_between = any(period % TICKS_PER_CONTROL for period in seeing)
        self._noise, self._physics = noise, parts.simulation.physics
        self._unobserved = 0  # ticks that no observing sensor has had yet
        self._early: dict[Sensor, Sample] = {}  # read before the tick was observed
        self.latest: dict[type[Sample], Sample] = {}

    def needs(self, index: int) -> bool:
        """Returns whether a sensor looks at the state at the end of a tick, counted from 1."""
        return bool(self._due[index % HIGHEST_RATE])

    def tick(self, index: int) -> tuple[Sample, ...]:
        """Returns the samples of the tick that has just been simulated, counted from 1."""
        due = self._due[index % HIGHEST_RATE]
        self._unobserved += 1
        if due or self._physics.is_last_shown:
            sums, self._unobserved = self._physics.latest_sums(self._unobserved), 0
            for observe in self._observe:
                observe(sums)
        return tuple([self._read(sensor) for sensor in due])

    def can_read_early(self, kinds: Collection[type[Sample]]) -> bool:
        """Returns whether samples of some kinds depend on nothing but the end of a control period."""
        own = [sensor for sensor, kind in self._kinds.items() if kind in kinds]
        alone = len({self._kinds[sensor] for sensor in own}) == len(own)
        return alone and not any(s.period_ticks % TICKS_PER_CONTROL or observes(s) for s in own)

    def read_early(self, index: int, kinds: Collection[type[Sample]]) -> None:
        """Reads at the end of a control period, before `tick` comes to it, what can be read early."""
        for sensor in self._due[index % HIGHEST_RATE]:
            if self._kinds[sensor] in kinds:
                self._early[sensor] = self._read(sensor)

    def errands(self, index: int, kinds: Collection[type[Sample]]) -> list[Errand]:
        """Returns the readings of some kinds, due at a later tick, that another thread can make."""
        due = self._due[index % HIGHEST_RATE]
        return [s.errand for s in due if s.errand is not None and self._kinds[s] in kinds]

    def before_reset(self) -> None:
        """Called when the rover is about to be put elsewhere."""
        for sensor in self._sensors:
            sensor.before_reset()

    def after_reset(self) -> None:
        """Called when it has been put there: what was read before is forgotten."""
        for sensor in self._sensors:
            sensor.after_reset()
        self.latest.clear()

    def _read(self, sensor: Sensor) -> Sample:
        if sensor in self._early:
            return self._early.pop(sensor)
        sample = sensor.read() if self._noise is None else self._noise.corrupt(sensor.read())
        kind, known_by = self._kinds[sensor], self._sources[sensor]
        if not isinstance(sample, kind) or source(sample) != known_by:
            raise misfit(sensor, sample, f"a {kind.__name__} of its own `name`, as `sensor`")
        self.latest[type(sample)] = sample
        return sample


def observes(sensor: Sensor) -> bool:
    """Returns whether a sensor takes every tick into account."""
    return type(sensor).observe is not Sensor.observe
