"""Faults that remember what a sensor has read: what freezes, comes late or comes less often."""

from collections import deque
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from harness.base.sim_time import NANOSECONDS
from harness.faults.base import Effect, Fault, Readings, SensorAct
from harness.samples import Sample


def frozen(merge: Callable[[Sample, Sample], Sample]) -> SensorAct:
    """Returns the act of a fault that merges readings with the last before it, or the first in it."""

    def act(fault: Fault[SensorAct], _: np.random.Generator) -> Effect:
        last: Sample | None = None

        def effect(readings: Readings, time_ns: int) -> Readings:
            nonlocal last
            if not readings:
                return readings
            if not fault.active(time_ns):
                last = readings[-1]
                return readings
            last = kept = readings[0] if last is None else last
            return tuple(merge(kept, reading) for reading in readings)

        return effect

    return act


def repeat(last: Sample, now: Sample) -> Sample:
    """Returns an old reading with the new stamp."""
    return replace(last, stamp_ns=now.stamp_ns)


def late(fault: Fault[SensorAct], _: np.random.Generator) -> Effect:
    """Returns what holds readings back; what is still held back delays the next."""
    delay_ns = round(fault.value * NANOSECONDS)
    held: deque[tuple[int, Sample]] = deque()

    def effect(readings: Readings, time_ns: int) -> Readings:
        due_ns = time_ns + (delay_ns if fault.active(time_ns) else 0)
        held.extend((due_ns, reading) for reading in readings)
        sent: list[Sample] = []
        while held and held[0][0] <= time_ns:
            sent.append(held.popleft()[1])
        return tuple(sent)

    return effect


def decimated(fault: Fault[SensorAct], _: np.random.Generator) -> Effect:
    """Returns what passes the first readings in each period of the lower rate."""
    last_period = -1

    def effect(readings: Readings, time_ns: int) -> Readings:
        nonlocal last_period
        if not readings or not fault.active(time_ns):
            return readings
        period = int((time_ns - fault.start_ns) * fault.value) // NANOSECONDS
        passes, last_period = period != last_period, period
        return readings if passes else ()

    return effect
