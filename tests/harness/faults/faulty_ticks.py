"""Ticks with every sensor, and what listeners get of them under faults."""

from collections.abc import Sequence

import numpy as np

from harness.faults.injector import FaultInjector
from harness.faults.spec import parse_faults
from harness.samples import (
    GroundTruth,
    Imu,
    JointStates,
    LaserScan,
    Odometry,
    Pose,
    Sample,
    Tick,
    Transforms,
    Twist,
)
from harness.sim_time import NANOSECONDS as SECOND
from harness.sim_time import TICK_NS as TICK

UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def tick(number: int) -> Tick:
    """A tick with every sensor; its number can be read from each value."""
    stamp, x = number * TICK, float(number)
    vector = (x, x, x)
    return Tick(
        stamp,
        (
            Transforms(stamp, vector, UPRIGHT),
            LaserScan(stamp, np.full(10, x, dtype=np.float32)),
            Imu(stamp, UPRIGHT, vector, vector),
            Pose(stamp, vector, UPRIGHT),
            Odometry(stamp, x, x, 0.5, Twist(x, x)),
            GroundTruth(stamp, x, x, 0.5, vector, vector),
            JointStates(stamp, vector, vector, vector),
        ),
    )


def sent(*specs: str, seconds: float = 4.0, seed: int = 0) -> list[Tick]:
    """What listeners get of an episode with these faults."""
    faults = FaultInjector(parse_faults(specs), seed)
    return [faults.corrupt(tick(number)) for number in range(1, round(seconds * 100) + 1)]


def readings(ticks: Sequence[Tick], kind: type[Sample]) -> list[Sample]:
    return [sample for one in ticks for sample in one.samples if type(sample) is kind]


def scans(*specs: str) -> list[LaserScan]:
    return [s for s in readings(sent(*specs), LaserScan) if isinstance(s, LaserScan)]


def imus(*specs: str, seed: int = 0) -> list[Imu]:
    return [s for s in readings(sent(*specs, seed=seed), Imu) if isinstance(s, Imu)]


def times(some: Sequence[Sample]) -> list[float]:
    return [reading.stamp_ns / SECOND for reading in some]
