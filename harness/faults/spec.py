"""A fault as a user writes it: SENSOR:FAULT[=VALUE][@START[+LENGTH]], e.g. imu:nan@10+2.

START and LENGTH are simulated seconds. Without a LENGTH a fault lasts to the end, without a START it
lasts the whole run.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from harness.errors import UsageError
from harness.faults.kinds import CLOCK, LONGEST, SENSORS, Kind, kinds
from harness.sim_time import NANOSECONDS

FORM = "SENSOR:FAULT[=VALUE][@START[+LENGTH]]"
_SPEC = re.compile(r"([^:=@+]+):([^:=@+]+)(?:=([^@]+))?(?:@([^+]+)(?:\+(.+))?)?")


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault of a run.

    Attributes:
        sensor: A name of SENSORS, or "clock".
        kind: A name of `kinds(sensor)`.
        value: In the unit of its kind; 0 if it takes none.
        start_ns: Simulation time of the first tick that it touches.
        end_ns: Simulation time from which it is over; None at the end of the run.
    """

    sensor: str
    kind: str
    value: float = 0.0
    start_ns: int = 0
    end_ns: int | None = None

    def active(self, time_ns: int) -> bool:
        """Whether it touches a tick of that simulation time."""
        return self.start_ns <= time_ns and (self.end_ns is None or time_ns < self.end_ns)


def parse_faults(specs: Iterable[str]) -> tuple[Fault, ...]:
    """Parses faults.

    Raises:
        UsageError: One is not valid; the message names what is.
    """
    return tuple(_parse(spec) for spec in specs)


def _parse(spec: str) -> Fault:
    found = _SPEC.fullmatch(spec)
    if found is None:
        raise UsageError(f"fault '{spec}' is not of the form {FORM}, e.g. imu:nan@10+2")
    sensor, name, value, start, length = found.groups()
    if sensor not in (*SENSORS, CLOCK):
        available = ", ".join((*SENSORS, CLOCK))
        raise UsageError(f"fault '{spec}': there is no sensor '{sensor}'; available: {available}")
    if name not in kinds(sensor):
        available = ", ".join(kinds(sensor))
        raise UsageError(f"fault '{spec}': {sensor} has no fault '{name}'; available: {available}")
    kind = kinds(sensor)[name]
    if kind.momentary and (start is None or length is not None):
        raise UsageError(f"fault '{spec}' happens at one time; give {sensor}:{name}@START")
    start_ns = 0 if start is None else _time_ns(spec, start, "START")
    end_ns = None if length is None else start_ns + _time_ns(spec, length, "LENGTH")
    if end_ns == start_ns:
        raise UsageError(f"fault '{spec}': LENGTH is 0 s; give more, or leave it out")
    return Fault(sensor, name, _value(spec, kind, value), start_ns, end_ns)


def _value(spec: str, kind: Kind, text: str | None) -> float:
    if kind.value is None:
        if text is not None:
            raise UsageError(f"fault '{spec}' takes no value; leave out '={text}'")
        return 0.0
    if text is None:
        if kind.value.default is None:
            raise UsageError(f"fault '{spec}' needs ={kind.value.name}: {kind.value.meaning}")
        return kind.value.default
    number = _number(text)
    if number is None or not kind.value.valid(number):
        raise UsageError(f"fault '{spec}': value '{text}' is not valid; give {kind.value.meaning}")
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
