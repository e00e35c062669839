"""Faults that remember what a sensor has read: what freezes, comes late or comes less often."""

from collections import deque
from dataclasses import replace

import numpy as np

from harness.faults.base import Effect, Readings, SensorFault, Value
from harness.samples import Sample
from harness.sim_time import NANOSECONDS


class Freeze(SensorFault):
    """The last reading again and again, with new stamps."""

    name = "freeze"

    def apply(self, _: np.random.Generator) -> Effect:
        """Returns what repeats the last reading before the fault, or the first in it."""
        last: Sample | None = None

        def effect(readings: Readings, time_ns: int) -> Readings:
            nonlocal last
            if not readings:
                return readings
            if not self.active(time_ns):
                last = readings[-1]
                return readings
            last = frozen = readings[0] if last is None else last
            return tuple(self._merge(frozen, reading) for reading in readings)

        return effect

    def _merge(self, last: Sample, now: Sample) -> Sample:
        return replace(last, stamp_ns=now.stamp_ns)


class StampFreeze(Freeze):
    """Stamps stand still."""

    name = "stamp-freeze"

    def _merge(self, last: Sample, now: Sample) -> Sample:
        return replace(now, stamp_ns=last.stamp_ns)


class Latency(SensorFault):
    """Messages come late, in order, with the stamp of the reading."""

    name, takes = "latency", Value("S", "seconds above 0 up to 60", lambda x: 0.0 < x <= 60.0)

    def apply(self, _: np.random.Generator) -> Effect:
        """Returns what holds readings back; what is still held back delays the next."""
        delay_ns = round(self.value * NANOSECONDS)
        held: deque[tuple[int, Sample]] = deque()

        def effect(readings: Readings, time_ns: int) -> Readings:
            due_ns = time_ns + (delay_ns if self.active(time_ns) else 0)
            held.extend((due_ns, reading) for reading in readings)
            sent: list[Sample] = []
            while held and held[0][0] <= time_ns:
                sent.append(held.popleft()[1])
            return tuple(sent)

        return effect


class Decimation(SensorFault):
    """At most so many messages a second."""

    name, takes = "rate", Value("HZ", "a rate above 0 up to 100 Hz", lambda x: 0.0 < x <= 100.0)

    def apply(self, _: np.random.Generator) -> Effect:
        """Returns what passes the first readings in each period of the lower rate."""
        last_period = -1

        def effect(readings: Readings, time_ns: int) -> Readings:
            nonlocal last_period
            if not readings or not self.active(time_ns):
                return readings
            period = int((time_ns - self.start_ns) * self.value) // NANOSECONDS
            passes, last_period = period != last_period, period
            return readings if passes else ()

        return effect
