"""A fault as a user writes it: SENSOR:FAULT[=VALUE][@START[+LENGTH]], e.g. imu:nan@10+2.

START and LENGTH are simulated seconds. Without a LENGTH a fault lasts to the end, without a START it
lasts the whole run.
"""

import re
from collections.abc import Iterable
from functools import cache
from typing import Any

from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS
from harness.faults.base import LONGEST, Fault, Kind
from harness.faults.clock import CLOCK
from harness.faults.kinds import OF_SENSORS, OF_THE_CLOCK
from harness.sensors import table
from harness.sensors.table import ATTITUDE, SensorRow

FORM = "SENSOR:FAULT[=VALUE][@START[+LENGTH]]"
_SPEC = re.compile(
    r"(?P<sensor>[^:=@+]+):(?P<name>[^:=@+]+)(?:=(?P<value>[^@]+))?"
    r"(?:@(?P<start>[^+]+)(?:\+(?P<length>.+))?)?"
)


def sensors(rows: Iterable[SensorRow] | None = None) -> tuple[str, ...]:
    """Returns the names of what can have faults, of some sensors or of all; the clock is the last."""
    named = table.by_fault_name(rows)
    return (*named, *(name + ATTITUDE for name, row in named.items() if row.attitude), CLOCK)


def faults_of(sensor: str, rows: Iterable[SensorRow] | None = None) -> dict[str, Kind[Any]]:
    """Returns the faults that a sensor, of some or of all, or the clock can have, by name."""
    kinds: tuple[Kind[Any], ...] = OF_THE_CLOCK if sensor == CLOCK else OF_SENSORS
    row = table.by_fault_name(rows).get(sensor)
    if row is not None and not row.measured:  # a camera's image is drawn later
        kinds = tuple(kind for kind in kinds if not kind.of_values)
    if sensor.endswith(ATTITUDE):
        return {kind.name: kind for kind in kinds if kind.of_values}
    return {kind.name: kind for kind in kinds if not kind.own or sensor in kind.own}


def parse_faults(
    specs: Iterable[str], rows: Iterable[SensorRow] | None = None
) -> tuple[Fault[Any], ...]:
    """Parses faults.

    Args:
        specs: As users write them.
        rows: The sensors of the run; None for all there are.

    Raises:
        UsageError: One is not valid; the message names what is.
    """
    known = None if rows is None else tuple(rows)
    return tuple(_parse(spec, known) for spec in specs)


@cache  # a run checks its options and then makes its faults
def _parse(spec: str, rows: tuple[SensorRow, ...] | None) -> Fault[Any]:
    found = _SPEC.fullmatch(spec)
    if found is None:
        raise UsageError(f"fault '{spec}' is not of the form {FORM}, e.g. imu:nan@10+2")
    sensor, name, value, start, length = found.groups()
    some, names = faults_of(sensor, rows), sensors(rows)
    if sensor not in names:
        optional = f", but --sensors {sensor} adds it" if sensor in sensors() else ""
        raise _unknown(spec, f"there is no sensor '{sensor}'{optional}", names)
    if name not in some:
        raise _unknown(spec, f"{sensor} has no fault '{name}'", some)
    kind = some[name]
    if kind.momentary and (start is None or length is not None):
        raise UsageError(f"fault '{spec}' happens at one time; give {sensor}:{name}@START")
    start_ns = 0 if start is None else _time_ns(spec, start, "START")
    end_ns = None if length is None else start_ns + _time_ns(spec, length, "LENGTH")
    if end_ns == start_ns:
        raise UsageError(f"fault '{spec}': LENGTH is 0 s; give more, or leave it out")
    return Fault(kind, sensor, _value(spec, kind, value), start_ns, end_ns)


def _unknown(spec: str, problem: str, available: Iterable[str]) -> UsageError:
    return UsageError(f"fault '{spec}': {problem}; available: {', '.join(available)}")


def _value(spec: str, kind: Kind[Any], text: str | None) -> float:
    takes = kind.takes
    if takes is None:
        if text is not None:
            raise UsageError(f"fault '{spec}' takes no value; leave out '={text}'")
        return 0.0
    if text is None:
        if takes.default is None:
            raise UsageError(f"fault '{spec}' needs ={takes.name}: {takes.meaning}")
        return takes.default
    number = _number(text)
    if number is None or not takes.valid(number):
        raise UsageError(f"fault '{spec}': value '{text}' is not valid; give {takes.meaning}")
    return number


def _time_ns(spec: str, text: str, what: str) -> int:
    seconds = _number(text)
    if seconds is None or not 0.0 <= seconds <= LONGEST:
        raise UsageError(f"fault '{spec}': {what} '{text}' is not valid; give seconds from 0 up")
    return round(seconds * NANOSECONDS)


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def describe_faults() -> str:
    """Returns sensors and faults for a command's help."""
    lines = [f"sensors: {', '.join(sensors())}; attitudes have those of values"]
    lines += ["each sensor:", *(_described(kind) for kind in OF_SENSORS if not kind.own)]
    for sensor in sensors():
        own = [_described(kind) for kind in faults_of(sensor).values() if kind.own or sensor == CLOCK]
        lines += [f"{sensor}:", *own] if own else []
    return "\n".join(lines)


def _described(kind: Kind[Any]) -> str:
    form = kind.name
    if kind.takes is not None:
        value = f"={kind.takes.name}"
        form += value if kind.takes.default is None else f"[{value}]"
    return f"  {form + '@START' * kind.momentary:22}{kind.summary}"
