"""What goes wrong between the sensors and their listeners: an iterator over ticks, seeded, no ROS.

The drive itself is untouched: the drivers of an episode see clean readings, so two runs that differ in
a fault differ in nothing else. Each fault draws from its own generator. Faults of one sensor act in
the order in which they are given, after the clock's.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from harness.base.streams import FAULTS, generator
from harness.faults.base import Fault, Readings
from harness.faults.clock import CLOCK, FaultyClock
from harness.samples import Sample, Source, Tick, source
from harness.sensors import table
from harness.sensors.table import ATTITUDE, SensorRow


class FaultInjector:
    """Makes the ticks of an episode into those of a faulty rover; give it every tick, in order.

    Args:
        faults: What goes wrong.
        seed: Of the run.
        rows: The sensors of the run; None for all there are.
        clock_seed: Of the clock's faults, which several rovers share; None for `seed`.

    Attributes:
        disturbs_time: Whether time will do anything else than go on by one tick after the other.
    """

    def __init__(
        self,
        faults: Iterable[Fault[Any]],
        seed: int,
        rows: Iterable[SensorRow] | None = None,
        clock_seed: int | None = None,
    ) -> None:
        of_clock = seed if clock_seed is None else clock_seed
        drawn = [
            (fault, generator(of_clock if fault.sensor == CLOCK else seed, FAULTS, index))
            for index, fault in enumerate(faults)
        ]
        clock_faults = [(fault, rng) for fault, rng in drawn if fault.sensor == CLOCK]
        self._faulty, self.disturbs_time = bool(drawn), bool(clock_faults)
        self._clock = FaultyClock(clock_faults)

        self._effects = {
            row.source: [f.kind.act(f, rng) for f, rng in drawn if f.sensor in (name, name + ATTITUDE)]
            for name, row in table.by_fault_name(rows).items()
        }

    def corrupt(self, tick: Tick) -> Tick:
        """Returns what listeners get: other readings, more, fewer or none, and another time.

        Samples that no fault can touch come as they are, after the others.
        """
        if not self._faulty:
            return tick
        clock = self._clock
        clock.advance(tick.stamp_ns)
        read: dict[Source, list[Sample]] = {kind: [] for kind in self._effects}
        others: list[Sample] = []
        for sample in tick.samples:
            read.get(source(sample), others).append(sample)
        sent: list[Sample] = []
        for kind, effects in self._effects.items():
            readings: Readings = tuple(_stamped(sample, clock.stamp_ns) for sample in read[kind])
            for effect in effects:
                readings = effect(readings, tick.stamp_ns)
            sent.extend(readings)
        return Tick(clock.clock_ns, (*sent, *others), clock.is_sent)


def _stamped(sample: Sample, stamp_ns: int) -> Sample:
    return sample if sample.stamp_ns == stamp_ns else replace(sample, stamp_ns=stamp_ns)
