"""Ticks with every sensor, and what listeners get of them under faults."""

from collections.abc import Sequence
from functools import cache
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from harness.base.sim_time import NANOSECONDS as SECOND
from harness.base.sim_time import TICK_NS as TICK
from harness.faults.injector import FaultInjector
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
from harness.sensors.table import SensorRow
from tests.support.words import parse_faults

ROWS = by_default()
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


@cache
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
            *(made(row, stamp, x) for row in ROWS if row.given is not None),
        ),
    )


def made(row: SensorRow, stamp: int, x: float) -> Sample:
    """A sample of an optional sensor with a number in every value."""
    named = {"stamp_ns": stamp, "sensor": row.fault}
    values = {name: _value(hint, x) for name, hint in _hints(row.sample).items() if name not in named}
    return row.sample(**values, **named)


@cache
def _hints(kind: type[Sample]) -> dict[str, Any]:
    return {name: get_type_hints(kind)[name] for name in kind.__dataclass_fields__}


def _value(hint: Any, x: float) -> object:  # noqa: ANN401 - a type or an alias
    plain, parts = get_origin(hint) or hint, get_args(hint)
    if type(None) in parts:
        return None
    if plain is np.ndarray:
        return np.full(10, x, get_args(parts[1])[0])
    if plain is tuple:
        return (x,) * (3 if Ellipsis in parts else len(parts))
    return plain(x)


@cache
def sent(*specs: str, seconds: float = 4.0, seed: int = 0) -> list[Tick]:
    """What listeners get of an episode with these faults."""
    faults = FaultInjector(parse_faults(specs), seed, ROWS)
    return [faults.corrupt(tick(number)) for number in range(1, round(seconds * 100) + 1)]


def readings(ticks: Sequence[Tick], kind: Source) -> list[Sample]:
    return [sample for one in ticks for sample in one.samples if kind in (type(sample), source(sample))]


def scans(*specs: str) -> list[LaserScan]:
    return [s for s in readings(sent(*specs), LaserScan) if isinstance(s, LaserScan)]


def imus(*specs: str, seed: int = 0) -> list[Imu]:
    return [s for s in readings(sent(*specs, seed=seed), Imu) if isinstance(s, Imu)]


def times(some: Sequence[Sample]) -> list[float]:
    return [reading.stamp_ns / SECOND for reading in some]


def said(one: Tick) -> str:
    """All that a tick says; the texts that numpy makes of arrays cost far more."""
    values = [[getattr(s, name) for name in s.__dataclass_fields__] for s in one.samples]
    plain = [[v.tobytes() if isinstance(v, np.ndarray) else v for v in some] for some in values]
    return repr((one.stamp_ns, one.tells_time, [type(s) for s in one.samples], plain))
