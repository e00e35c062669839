"""What goes wrong between the sensors and whoever listens: an iterator over ticks, seeded, no ROS.

The drive itself is untouched: the drivers of an episode see clean readings, so two runs that differ in
a fault differ in nothing else. Each fault draws from its own generator. Faults of one sensor act in
the order in which they are given, after the clock's.
"""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Protocol

import numpy as np

from harness.faults.clock import FaultyClock
from harness.faults.kinds import CLOCK, SENSORS
from harness.faults.readings import CORRUPT
from harness.faults.spec import Fault
from harness.samples import Sample, Tick, TruthState
from harness.sim_time import NANOSECONDS

RANDOM_STREAM = 11  # keeps these generators apart from those of the episode

Readings = tuple[Sample, ...]


class Effect(Protocol):
    """One fault at work on one sensor."""

    def through(self, readings: Readings, time_ns: int) -> Readings:
        """What is sent at a tick, in order, for what the sensor has read; ask at every tick."""
        ...


class EachByItself:
    """Changes readings one by one."""

    def __init__(self, fault: Fault, rng: np.random.Generator) -> None:
        self._fault, self._rng = fault, rng
        self._corrupt = CORRUPT[fault.kind]

    def through(self, readings: Readings, time_ns: int) -> Readings:
        """Changes them while the fault lasts."""
        if not self._fault.active(time_ns):
            return readings
        return tuple(s for r in readings for s in self._corrupt(r, self._fault.value, self._rng))


class Frozen:
    """Repeats a part of the last reading before the fault, or of the first in it."""

    def __init__(self, fault: Fault, merge: Callable[[Sample, Sample], Sample]) -> None:
        self._fault, self._merge = fault, merge
        self._last: Sample | None = None

    def through(self, readings: Readings, time_ns: int) -> Readings:
        """Merges the remembered reading into each while the fault lasts."""
        if self._fault.active(time_ns):
            return tuple(self._merged(reading) for reading in readings)
        if readings:
            self._last = readings[-1]
        return readings

    def _merged(self, reading: Sample) -> Sample:
        if self._last is None:
            self._last = reading
        return self._merge(self._last, reading)


class Late:
    """Holds readings back; none overtakes another, so what is still held back delays the next."""

    def __init__(self, fault: Fault) -> None:
        self._fault = fault
        self._delay_ns = round(fault.value * NANOSECONDS)
        self._held: deque[tuple[int, Sample]] = deque()

    def through(self, readings: Readings, time_ns: int) -> Readings:
        """Takes the readings; gives those that are due."""
        delay_ns = self._delay_ns if self._fault.active(time_ns) else 0
        self._held.extend((time_ns + delay_ns, reading) for reading in readings)
        sent: list[Sample] = []
        while self._held and self._held[0][0] <= time_ns:
            sent.append(self._held.popleft()[1])
        return tuple(sent)


class Thinned:
    """Passes the first reading in each period of a lower rate."""

    def __init__(self, fault: Fault) -> None:
        self._fault = fault
        self._period = -1

    def through(self, readings: Readings, time_ns: int) -> Readings:
        """Leaves out what comes too soon after the last."""
        if not readings or not self._fault.active(time_ns):
            return readings
        elapsed_ns = time_ns - self._fault.start_ns
        period = int(elapsed_ns * self._fault.value) // NANOSECONDS
        if period == self._period:
            return ()
        self._period = period
        return readings


class FaultInjector:
    """Makes the ticks of an episode into those of a faulty rover; give it every tick, in order."""

    def __init__(self, faults: Iterable[Fault], seed: int) -> None:
        drawn = [(fault, _generator(seed, index)) for index, fault in enumerate(faults)]
        self._faulty = bool(drawn)
        self._clock = FaultyClock([(fault, rng) for fault, rng in drawn if fault.sensor == CLOCK])
        self._effects: dict[type[Sample], list[Effect]] = {kind: [] for kind in SENSORS.values()}
        for fault, rng in drawn:
            if fault.sensor != CLOCK:
                self._effects[SENSORS[fault.sensor]].append(_effect(fault, rng))

    def corrupt(self, tick: Tick) -> Tick:
        """What listeners get of a tick: other readings, more, fewer or none, and another time."""
        if not self._faulty:
            return tick
        clock = self._clock
        clock.advance(tick.stamp_ns)
        sent: list[Sample] = []
        for kind, effects in self._effects.items():
            read = (sample for sample in tick.samples if type(sample) is kind)
            readings: Readings = tuple(replace(sample, stamp_ns=clock.stamp_ns) for sample in read)
            for effect in effects:
                readings = effect.through(readings, tick.stamp_ns)
            sent.extend(readings)
        sent.extend(sample for sample in tick.samples if isinstance(sample, TruthState))
        return Tick(clock.told_ns, tuple(sent), clock.tells)


def disturb_time(faults: Iterable[Fault]) -> bool:
    """Whether time will do anything else than go on by one tick after the other."""
    return any(fault.sensor == CLOCK for fault in faults)


def _effect(fault: Fault, rng: np.random.Generator) -> Effect:
    match fault.kind:
        case "freeze":
            return Frozen(fault, lambda last, now: replace(last, stamp_ns=now.stamp_ns))
        case "stamp-freeze":
            return Frozen(fault, lambda last, now: replace(now, stamp_ns=last.stamp_ns))
        case "latency":
            return Late(fault)
        case "rate":
            return Thinned(fault)
    return EachByItself(fault, rng)


def _generator(seed: int, index: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(RANDOM_STREAM, index)))
