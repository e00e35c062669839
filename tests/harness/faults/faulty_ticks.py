"""Ticks with every sensor, and what listeners get of them under faults."""

from collections.abc import Sequence
from typing import Any, get_args, get_origin, get_type_hints

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
    Source,
    Tick,
    Transforms,
    Twist,
    source,
)
from harness.sensors.choice import by_default
from harness.sim_time import NANOSECONDS as SECOND
from harness.sim_time import TICK_NS as TICK

ROWS = by_default()
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


def carried(number: int, name: str) -> Tick:
    """A tick with an optional sensor alone; its number can be read from each value."""
    (row,) = (row for row in ROWS if row.source == name)
    hints = get_type_hints(row.sample)
    values = {field: _value(hints[field], float(number)) for field in row.sample.__dataclass_fields__}
    sample = row.sample(**values | {"stamp_ns": number * TICK, "sensor": name})
    return Tick(number * TICK, (sample,))


def _value(hint: Any, x: float) -> object:  # noqa: ANN401 - a type or an alias
    plain, parts = get_origin(hint) or hint, get_args(hint)
    if plain is np.ndarray:
        return np.full(10, x, get_args(parts[1])[0])
    if plain is tuple:
        return (x,) * (3 if Ellipsis in parts else len(parts))
    return plain(x)


def sent(*specs: str, seconds: float = 4.0, seed: int = 0, optional: str | None = None) -> list[Tick]:
    """What listeners get of an episode with these faults, or of an optional sensor in it."""
    faults = FaultInjector(parse_faults(specs), seed, ROWS)
    numbers = range(1, round(seconds * 100) + 1)
    return [faults.corrupt(carried(n, optional) if optional else tick(n)) for n in numbers]


def readings(ticks: Sequence[Tick], kind: Source) -> list[Sample]:
    return [sample for one in ticks for sample in one.samples if source(sample) == kind]


def scans(*specs: str) -> list[LaserScan]:
    return [s for s in readings(sent(*specs), LaserScan) if isinstance(s, LaserScan)]


def imus(*specs: str, seed: int = 0) -> list[Imu]:
    return [s for s in readings(sent(*specs, seed=seed), Imu) if isinstance(s, Imu)]


def times(some: Sequence[Sample]) -> list[float]:
    return [reading.stamp_ns / SECOND for reading in some]
