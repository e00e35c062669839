"""Faults that change one reading by itself: pure functions from a reading to what is sent for it."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.samples import (
    GroundTruth,
    Imu,
    JointStates,
    LaserScan,
    Odometry,
    Pose,
    Sample,
    Twist,
)
from harness.sim_time import NANOSECONDS

HUGE = 1e30  # fits float32; its square fits float64
SPIKE_SHARE = 0.1

Values = NDArray[np.float64]
Change = Callable[[Values], Values]
Corrupt = Callable[[Sample, float, np.random.Generator], tuple[Sample, ...]]

# What a sensor measures. Attitudes are left alone: a quaternion has no single value that is off.
MEASURED: dict[type[Sample], tuple[str, ...]] = {
    LaserScan: ("ranges",),
    Imu: ("angular_velocity", "linear_acceleration"),
    Pose: ("position",),
    Odometry: ("x", "y", "twist"),
    GroundTruth: ("x", "y", "linear_velocity", "angular_velocity"),
    JointStates: ("position", "velocity", "effort"),
}


def measured_as(reading: Sample, change: Change) -> Sample:
    """The reading with a function applied to everything that it measures."""
    changes = {name: _changed(getattr(reading, name), change) for name in MEASURED[type(reading)]}
    return replace(reading, **changes)


def _changed(value: Any, change: Change) -> Any:  # noqa: ANN401 - a sample's field
    if isinstance(value, np.ndarray):
        return change(value.astype(np.float64)).astype(np.float32)
    if isinstance(value, tuple):
        return tuple(change(np.array(value, dtype=np.float64)).tolist())
    if isinstance(value, Twist):
        linear, angular = change(np.array([value.linear, value.angular])).tolist()
        return Twist(linear, angular)
    return float(change(np.array([value]))[0])


def _some_are(number: float) -> Corrupt:
    def corrupt(reading: Sample, share: float, rng: np.random.Generator) -> tuple[Sample, ...]:
        def hit(values: Values) -> Values:
            hit_values: Values = np.where(rng.random(values.shape) < share, number, values)
            return hit_values

        return (measured_as(reading, hit),)

    return corrupt


def _stuck(reading: Sample, number: float, _: np.random.Generator) -> tuple[Sample, ...]:
    return (measured_as(reading, lambda values: np.full_like(values, number)),)


def _spike(reading: Sample, size: float, rng: np.random.Generator) -> tuple[Sample, ...]:
    def spiked(values: Values) -> Values:
        hit = rng.random(values.shape) < SPIKE_SHARE
        off: Values = hit * size * rng.choice((-1.0, 1.0), values.shape)
        return values + off

    return (measured_as(reading, spiked),)


def _dropout(reading: Sample, share: float, rng: np.random.Generator) -> tuple[Sample, ...]:
    return () if rng.random() < share else (reading,)


def _duplicate(reading: Sample, copies: float, _: np.random.Generator) -> tuple[Sample, ...]:
    return (reading,) * int(copies)


def _shift_stamp(reading: Sample, seconds: float, _: np.random.Generator) -> tuple[Sample, ...]:
    stamp_ns = max(0, reading.stamp_ns + round(seconds * NANOSECONDS))
    return (replace(reading, stamp_ns=stamp_ns),)


def _beams(reading: Sample, number: float, _: np.random.Generator) -> tuple[Sample, ...]:
    assert isinstance(reading, LaserScan)  # noqa: S101 - the grammar gives it to no other sensor
    ranges = np.full(int(number), np.inf, dtype=np.float32)
    kept = reading.ranges[: int(number)]
    ranges[: kept.size] = kept
    return (replace(reading, ranges=ranges),)


def _empty(reading: Sample, _number: float, _rng: np.random.Generator) -> tuple[Sample, ...]:
    match reading:
        case LaserScan():
            return (replace(reading, ranges=reading.ranges[:0]),)
        case Pose():
            return (replace(reading, position=(np.nan,) * 3, empty=True),)
        case JointStates():
            return (replace(reading, position=(), velocity=(), effort=()),)
    raise AssertionError  # the grammar gives it to no other sensor


CORRUPT: dict[str, Corrupt] = {
    "dropout": _dropout,
    "duplicate": _duplicate,
    "stuck": _stuck,
    "zero": _some_are(0.0),
    "nan": _some_are(np.nan),
    "inf": _some_are(np.inf),
    "huge": _some_are(HUGE),
    "spike": _spike,
    "stamp-shift": _shift_stamp,
    "empty": _empty,
    "beams": _beams,
}
