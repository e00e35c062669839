"""Faults that change one reading by itself, whatever came before."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import NANOSECONDS
from harness.faults.base import Effect, Fault, Readings, SensorAct
from harness.samples import JointStates, LaserScan, Pose, Sample, Twist
from harness.sensors import table
from rover_metrics.plugins import misfit

SPIKE_SHARE = 0.1
NUMBERS = "biuf"  # the kinds of numpy's types that are real numbers

Values = NDArray[np.float64]
Change = Callable[[Sample, float, np.random.Generator], Readings]  # what is sent, by the fault's value
# A field's values, shape (n,), by the fault's.
Hit = Callable[[Values, float, np.random.Generator], Values]


def each(change: Change) -> SensorAct:
    """Returns the act of a fault that changes readings one by one."""

    def act(fault: Fault[SensorAct], rng: np.random.Generator) -> Effect:
        def effect(readings: Readings, time_ns: int) -> Readings:
            if not fault.active(time_ns):
                return readings
            return tuple(sent for reading in readings for sent in change(reading, fault.value, rng))

        return effect

    return act


def measured(hit: Hit) -> SensorAct:
    """Returns the act of a fault of all that a sensor measures, or of its attitude."""

    def shaped(values: Values, value: float, rng: np.random.Generator) -> Values:
        result = np.asarray(given := hit(values, value, rng))
        if result.shape != values.shape or result.dtype.kind not in NUMBERS:
            raise misfit(hit, given, f"{values.size} numbers")
        return result

    def act(fault: Fault[SensorAct], rng: np.random.Generator) -> Effect:
        fields = "attitude" if fault.sensor.endswith(table.ATTITUDE) else "measured"

        def change(reading: Sample, value: float, rng: np.random.Generator) -> Readings:
            # Kinds of sensors that share a sample have the same fields.
            row = table.row_of(type(reading))
            names = getattr(row, fields)
            changed = {n: _changed(getattr(reading, n), lambda v: shaped(v, value, rng)) for n in names}
            return (replace(reading, **changed),)

        return each(change)(fault, rng)

    return act


def becomes(wrong: float) -> SensorAct:
    """Returns the act of a fault that puts a number in the place of a share of the values."""

    def hit(values: Values, share: float, rng: np.random.Generator) -> Values:
        return np.where(rng.random(values.shape) < share, wrong, values)

    return measured(hit)


def shift(reading: Sample, seconds: float, _: np.random.Generator) -> Readings:
    """Returns the reading with its stamp off by so many seconds, not below 0."""
    return (replace(reading, stamp_ns=max(0, reading.stamp_ns + round(seconds * NANOSECONDS))),)


def spike(values: Values, size: float, rng: np.random.Generator) -> Values:
    """Returns the values, one in ten of which is off.

    Args:
        values: Of one field, shape (n,).
        size: By how much, in their unit; the sign is random.
        rng: Chooses which.
    """
    is_hit = rng.random(values.shape) < SPIKE_SHARE
    off: Values = is_hit * size * rng.choice((-1.0, 1.0), values.shape)
    return values + off


def empty(reading: Sample, *_: object) -> Readings:
    """Returns a reading without content: no ranges, no pose, no joints."""
    match reading:
        case LaserScan():
            return (replace(reading, ranges=reading.ranges[:0]),)
        case Pose():
            return (replace(reading, position=(np.nan,) * 3, empty=True),)
        case JointStates():
            return (replace(reading, position=(), velocity=(), effort=()),)
    raise AssertionError  # the grammar gives it to no other sensor


def resize(reading: Sample, beams: float, _: np.random.Generator) -> Readings:
    """Returns the scan with another number of beams."""
    assert isinstance(reading, LaserScan)  # noqa: S101 - the grammar gives it to no other sensor
    ranges = np.full(int(beams), np.inf, dtype=np.float32)
    kept = reading.ranges[: int(beams)]
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
