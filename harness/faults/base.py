"""What a fault is: a frozen value that a user's words are parsed into, and what values there are.

Each fault is a class of its own in harness.faults.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from harness.errors import UsageError
from harness.samples import Sample
from harness.sim_time import NANOSECONDS

LONGEST = 1e8  # [s]: stamps have 31 bits of seconds

Readings = tuple[Sample, ...]
Effect = Callable[[Readings, int], Readings]  # what is sent at a tick [ns] for what was read


@dataclass(frozen=True)
class Value:
    """What may stand behind the '='.

    Attributes:
        name: Placeholder in the help.
        meaning: Which numbers are valid, as an error message says it.
        valid: Whether a number is.
        default: Taken if none is given; None if one must be.
    """

    name: str
    meaning: str
    valid: Callable[[float], bool]
    default: float | None = None


SHARE = Value("SHARE", "a share above 0 up to 1", lambda x: 0.0 < x <= 1.0, default=1.0)


@dataclass(frozen=True)
class Fault:
    """One fault of a run. The docstring of each class is its line in the help.

    Attributes:
        name: As in --fault.
        takes: What may stand behind the '='; None for nothing.
        momentary: Whether it happens at one time, instead of lasting.
        own: The only sensors that can have it; empty if all can.
        sensor: The name of its sensor.
        value: In the unit of `takes`; 0 if it takes none.
        start_ns: Simulation time of the first tick that it touches.
        end_ns: Simulation time from which it is over; None at the end of the run.
    """

    name: ClassVar[str]
    takes: ClassVar[Value | None] = None
    momentary: ClassVar[bool] = False
    own: ClassVar[tuple[str, ...]] = ()

    sensor: str
    value: float = 0.0
    start_ns: int = 0
    end_ns: int | None = None

    @classmethod
    def parse(cls, spec: str, words: Mapping[str, str | None]) -> Self:
        """Returns the fault that a user has written.

        Args:
            spec: As it was written, for messages.
            words: Its sensor, name, value, start and length; None for those left out.

        Raises:
            UsageError: One of them is not valid; the message names what is.
        """
        sensor, start, length = str(words["sensor"]), words["start"], words["length"]
        if cls.momentary and (start is None or length is not None):
            raise UsageError(f"fault '{spec}' happens at one time; give {sensor}:{cls.name}@START")
        start_ns = 0 if start is None else _time_ns(spec, start, "START")
        end_ns = None if length is None else start_ns + _time_ns(spec, length, "LENGTH")
        if end_ns == start_ns:
            raise UsageError(f"fault '{spec}': LENGTH is 0 s; give more, or leave it out")
        return cls(sensor, cls._value(spec, words["value"]), start_ns, end_ns)

    @classmethod
    def _value(cls, spec: str, text: str | None) -> float:
        if cls.takes is None:
            if text is not None:
                raise UsageError(f"fault '{spec}' takes no value; leave out '={text}'")
            return 0.0
        if text is None:
            if cls.takes.default is None:
                raise UsageError(f"fault '{spec}' needs ={cls.takes.name}: {cls.takes.meaning}")
            return cls.takes.default
        number = _number(text)
        if number is None or not cls.takes.valid(number):
            raise UsageError(f"fault '{spec}': value '{text}' is not valid; give {cls.takes.meaning}")
        return number

    @classmethod
    def described(cls) -> str:
        """Returns its line in the help."""
        form = cls.name
        if cls.takes is not None:
            value = f"={cls.takes.name}"
            form += value if cls.takes.default is None else f"[{value}]"
        summary = (cls.__doc__ or "").rstrip(".")
        return f"  {form + '@START' * cls.momentary:22}{summary[:1].lower()}{summary[1:]}"

    def active(self, time_ns: int) -> bool:
        """Returns whether it touches a tick of that simulation time."""
        return self.start_ns <= time_ns and (self.end_ns is None or time_ns < self.end_ns)


class SensorFault(Fault):
    """A fault of a sensor."""

    def apply(self, rng: np.random.Generator) -> Effect:
        """Returns the fault at work in one run; it is to be asked at every tick."""
        raise NotImplementedError


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
