"""A fault as a user writes it: SENSOR:FAULT[=VALUE][@START[+LENGTH]], e.g. imu:nan@10+2.

START and LENGTH are simulated seconds. Without a LENGTH a fault lasts to the end, without a START it
lasts the whole run.
"""

import re
from collections.abc import Iterable
from functools import cache

from harness.errors import UsageError
from harness.faults import clock, readings, streams
from harness.faults.base import Fault
from harness.sensors import table

FAULTS: tuple[type[Fault], ...] = (  # in the order in which the help shows them
    readings.Dropout,
    streams.Decimation,
    streams.Latency,
    readings.Duplicate,
    streams.Freeze,
    readings.Stuck,
    readings.Zero,
    readings.Nan,
    readings.Inf,
    readings.Huge,
    readings.Spike,
    readings.StampShift,
    streams.StampFreeze,
    readings.Empty,
    readings.Beams,
    clock.ClockJump,
    clock.ClockReset,
    clock.ClockSpeed,
    clock.ClockFreeze,
    clock.ClockDropout,
)

FORM = "SENSOR:FAULT[=VALUE][@START[+LENGTH]]"
_SPEC = re.compile(
    r"(?P<sensor>[^:=@+]+):(?P<name>[^:=@+]+)(?:=(?P<value>[^@]+))?"
    r"(?:@(?P<start>[^+]+)(?:\+(?P<length>.+))?)?"
)


def sensors() -> tuple[str, ...]:
    """Returns the names of all sensors that can have faults; the clock is the last."""
    return (*table.by_fault_name(), clock.CLOCK)


def faults_of(sensor: str) -> dict[str, type[Fault]]:
    """Returns the faults that a sensor or the clock can have, by name."""
    return {f.name: f for f in FAULTS if sensor in f.own or (not f.own and sensor != clock.CLOCK)}


def parse_faults(specs: Iterable[str]) -> tuple[Fault, ...]:
    """Parses faults.

    Raises:
        UsageError: One is not valid; the message names what is.
    """
    return tuple(_parse(spec) for spec in specs)


@cache  # a run checks its options and then makes its faults
def _parse(spec: str) -> Fault:
    found = _SPEC.fullmatch(spec)
    if found is None:
        raise UsageError(f"fault '{spec}' is not of the form {FORM}, e.g. imu:nan@10+2")
    sensor, name = found["sensor"], found["name"]
    some = faults_of(sensor)
    if sensor not in sensors():
        problem, available = f"there is no sensor '{sensor}'", sensors()
    elif name not in some:
        problem, available = f"{sensor} has no fault '{name}'", tuple(some)
    else:
        return some[name].parse(spec, found.groupdict())
    raise UsageError(f"fault '{spec}': {problem}; available: {', '.join(available)}")


def describe_faults() -> str:
    """Returns sensors and faults for a command's help."""
    lines = [f"sensors: {', '.join(sensors())}"]
    lines += ["each sensor:", *(fault.described() for fault in FAULTS if not fault.own)]
    for sensor in sensors():
        own = [fault.described() for fault in FAULTS if sensor in fault.own]
        lines += [f"{sensor}:", *own] if own else []
    return "\n".join(lines)
