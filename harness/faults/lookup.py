"""Faults by the names of sensors and kinds (harness.spec.fault: how a user writes them)."""

from collections import Counter
from collections.abc import Iterable
from functools import cache
from typing import Any

from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS
from harness.faults.actuation import WHEEL
from harness.faults.base import Fault, Kind
from harness.faults.clock import CLOCK
from harness.faults.kinds import DUPLICATE, FAULTS, OF_ACTUATION, OF_SENSORS, OF_THE_CLOCK, OF_WHEELS
from harness.sensors import table
from harness.sensors.table import ATTITUDE, SensorRow
from harness.spec.fault import FaultSpec

MOST_COPIES = 1000  # of a message, by all duplicate faults of its sensor: they multiply


def sensors(rows: Iterable[SensorRow] | None = None) -> tuple[str, ...]:
    """Returns the names of what can have faults, of some sensors or of all; the clock is the last."""
    named = table.by_fault_name(rows)
    return (*named, *(name + ATTITUDE for name, row in named.items() if row.attitude), CLOCK)


def faults_of(sensor: str, rows: Iterable[SensorRow] | None = None) -> dict[str, Kind[Any]]:
    """Returns the faults of this project that a sensor, of some or of all, or the clock can have."""
    actuated = OF_WHEELS if sensor.startswith(WHEEL) else OF_ACTUATION.get(sensor)
    if actuated is not None:
        return {kind.name: kind for kind in actuated}
    kinds: tuple[Kind[Any], ...] = OF_THE_CLOCK if sensor == CLOCK else OF_SENSORS
    return {kind.name: kind for kind in kinds if _can_have(sensor, kind, rows)}


def _can_have(sensor: str, kind: Kind[Any], rows: Iterable[SensorRow] | None) -> bool:
    row = table.by_fault_name(rows).get(sensor)
    if row is not None and not row.measured and kind.of_values:  # a camera's image is drawn later
        return False
    if sensor.endswith(ATTITUDE):
        return kind.of_values
    return not kind.own or sensor in kind.own


def find_faults(specs: Iterable[FaultSpec], rows: Iterable[SensorRow] | None) -> tuple[Fault[Any], ...]:
    """Returns the faults that are asked for of some sensors, or of all there are.

    Raises:
        UsageError: There is no such sensor or fault, or a value is not valid; the message names what is.
    """
    known = None if rows is None else tuple(rows)
    faults, copies = tuple(_find(spec, known) for spec in specs), Counter[str]()
    for fault in faults:
        if fault.kind.name == DUPLICATE:
            copies[fault.sensor] = int(fault.value) * (copies[fault.sensor] or 1)
    for sensor, count in copies.items():
        if count > MOST_COPIES:
            each = f"faults of {sensor} send each message {count:,} times"
            raise UsageError(f"{each}; give {DUPLICATE}s that come to {MOST_COPIES:,} at most")
    return faults


@cache  # a run checks its options and then makes its faults
def _find(spec: FaultSpec, rows: tuple[SensorRow, ...] | None) -> Fault[Any]:
    sensor, some = spec.sensor, faults_of(spec.sensor, rows)
    is_sensor, names = sensor in sensors(rows), (*sensors(rows), *OF_ACTUATION)
    if sensor not in names and not sensor.startswith(WHEEL):
        optional = f", but --sensors {sensor} adds it" if sensor in sensors() else ""
        no_such = f"there is no sensor '{sensor}'{optional}"
        raise UsageError(f"fault '{spec}': {no_such}; available: {', '.join(names)}")
    if (
        is_sensor and sensor != CLOCK and spec.kind not in some and spec.kind in FAULTS
    ):  # somebody else's
        other = FAULTS[spec.kind]
        some |= {spec.kind: other} if _can_have(sensor, other, rows) else {}
    if spec.kind not in some:
        no_such = f"{sensor} has no fault '{spec.kind}'"
        raise UsageError(f"fault '{spec}': {no_such}; available: {', '.join(some)}")
    kind = some[spec.kind]
    if kind.momentary and (spec.start is None or spec.length is not None):
        raise UsageError(f"fault '{spec}' happens at one time; give {sensor}:{spec.kind}@START")
    start_ns = round((spec.start or 0.0) * NANOSECONDS)
    end_ns = None if spec.length is None else start_ns + round(spec.length * NANOSECONDS)
    if end_ns == start_ns:
        raise UsageError(f"fault '{spec}': LENGTH is below 1 ns; give more, or leave it out")
    return Fault(kind, sensor, _value(spec, kind), start_ns, end_ns)


def _value(spec: FaultSpec, kind: Kind[Any]) -> float:
    takes, value = kind.takes, spec.value
    if takes is None:
        if value is not None:
            raise UsageError(f"fault '{spec}' takes no value; leave out what stands behind '='")
        return 0.0
    if value is None:
        if takes.default is None:
            raise UsageError(f"fault '{spec}' needs ={takes.name}: {takes.meaning}")
        return takes.default
    if not takes.valid(value):
        raise UsageError(f"fault '{spec}': the value is not valid; give {takes.meaning}")
    return value


def describe_faults() -> str:
    """Returns sensors and faults for a command's help."""
    lines = [f"sensors: {', '.join(sensors())}; attitudes have those of values"]
    lines += ["each sensor:", *(_described(kind) for kind in OF_SENSORS if not kind.own)]
    for sensor in sensors():
        own = [_described(kind) for kind in faults_of(sensor).values() if kind.own or sensor == CLOCK]
        lines += [f"{sensor}:", *own] if own else []
    lines += [
        line
        for sensor, kinds in OF_ACTUATION.items()
        for line in (f"{sensor}:", *map(_described, kinds))
    ]
    return "\n".join(lines)


def _described(kind: Kind[Any]) -> str:
    form = kind.name
    if kind.takes is not None:
        value = f"={kind.takes.name}"
        form += value if kind.takes.default is None else f"[{value}]"
    return f"  {form + '@START' * kind.momentary:22}{kind.summary}"
