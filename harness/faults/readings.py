"""Faults that change one reading by itself, whatever came before."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.faults.base import LONGEST, SHARE, Effect, Readings, SensorFault, Value
from harness.samples import JointStates, LaserScan, Pose, Sample, Twist
from harness.sensors import table
from harness.sim_time import NANOSECONDS

SPIKE_SHARE = 0.1

Values = NDArray[np.float64]


class PerSample(SensorFault):
    """A fault that changes readings one by one: `_change` returns what is sent for each."""

    def apply(self, rng: np.random.Generator) -> Effect:
        """Returns what changes readings while the fault lasts."""

        def effect(readings: Readings, time_ns: int) -> Readings:
            if not self.active(time_ns):
                return readings
            return tuple(sent for reading in readings for sent in self._change(reading, rng))

        return effect

    def _change(self, reading: Sample, rng: np.random.Generator) -> Readings:
        raise NotImplementedError


class ValueFault(PerSample):
    """A fault of all that a sensor measures: `_hit` returns what is sent for a field's values."""

    def _change(self, reading: Sample, rng: np.random.Generator) -> Readings:
        changed = {
            name: _changed(getattr(reading, name), lambda values: self._hit(values, rng))
            for name in table.by_fault_name()[self.sensor].measured
        }
        return (replace(reading, **changed),)

    def _hit(self, values: Values, rng: np.random.Generator) -> Values:
        raise NotImplementedError


class Dropout(PerSample):
    """Messages are not sent."""

    name, takes = "dropout", SHARE

    def _change(self, reading: Sample, rng: np.random.Generator) -> Readings:
        return () if rng.random() < self.value else (reading,)


class Duplicate(PerSample):
    """Each message is sent N times."""

    name = "duplicate"
    takes = Value("N", "a whole number from 2 to 10", lambda x: x in range(2, 11), default=2.0)

    def _change(self, reading: Sample, _: np.random.Generator) -> Readings:
        return (reading,) * int(self.value)


class StampShift(PerSample):
    """Stamps are off by S."""

    name = "stamp-shift"
    takes = Value("S", "seconds, negative for back in time", lambda x: abs(x) <= LONGEST)

    def _change(self, reading: Sample, _: np.random.Generator) -> Readings:
        stamp_ns = max(0, reading.stamp_ns + round(self.value * NANOSECONDS))
        return (replace(reading, stamp_ns=stamp_ns),)


class Stuck(ValueFault):
    """Every value is X."""

    name, takes = "stuck", Value("X", "a number, inf or nan", lambda _: True)

    def _hit(self, values: Values, _: np.random.Generator) -> Values:
        return np.full_like(values, self.value)


class Zero(ValueFault):
    """Values are 0."""

    name, takes = "zero", SHARE
    becomes: ClassVar[float] = 0.0

    def _hit(self, values: Values, rng: np.random.Generator) -> Values:
        hit: Values = np.where(rng.random(values.shape) < self.value, self.becomes, values)
        return hit


class Nan(Zero):
    """Values are NaN."""

    name, becomes = "nan", math.nan


class Inf(Zero):
    """Values are infinite."""

    name, becomes = "inf", math.inf


class Huge(Zero):
    """Values are 1e30."""

    name, becomes = "huge", 1e30  # fits float32; its square fits float64


class Spike(ValueFault):
    """One value in ten, at random, is off by SIZE."""

    name = "spike"
    takes = Value("SIZE", "a size above 0", lambda x: 0.0 < x < math.inf, default=10.0)

    def _hit(self, values: Values, rng: np.random.Generator) -> Values:
        is_hit = rng.random(values.shape) < SPIKE_SHARE
        off: Values = is_hit * self.value * rng.choice((-1.0, 1.0), values.shape)
        return values + off


class Empty(PerSample):
    """A message without readings."""

    name, own = "empty", ("scan", "pose", "joint_states")

    def _change(self, reading: Sample, _: np.random.Generator) -> Readings:
        match reading:
            case LaserScan():
                return (replace(reading, ranges=reading.ranges[:0]),)
            case Pose():
                return (replace(reading, position=(np.nan,) * 3, empty=True),)
            case JointStates():
                return (replace(reading, position=(), velocity=(), effort=()),)
        raise AssertionError  # the grammar gives it to no other sensor


class Beams(PerSample):
    """Only the first N ranges, or more that miss."""

    name, own = "beams", ("scan",)
    takes = Value("N", "a whole number from 0 to 100000", lambda x: x in range(100_001))

    def _change(self, reading: Sample, _: np.random.Generator) -> Readings:
        assert isinstance(reading, LaserScan)  # noqa: S101 - the grammar gives it to no other sensor
        ranges = np.full(int(self.value), np.inf, dtype=np.float32)
        kept = reading.ranges[: int(self.value)]
        ranges[: kept.size] = kept
        return (replace(reading, ranges=ranges),)


def _changed(value: Any, change: Callable[[Values], Values]) -> Any:  # noqa: ANN401 - a sample's field
    if isinstance(value, np.ndarray):
        return change(value.astype(np.float64)).astype(np.float32)
    if isinstance(value, tuple):
        return tuple(change(np.array(value, dtype=np.float64)).tolist())
    if isinstance(value, Twist):
        linear, angular = change(np.array([value.linear, value.angular])).tolist()
        return Twist(linear, angular)
    return float(change(np.array([value]))[0])
