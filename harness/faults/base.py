"""What a fault is: one of the kinds that there are, at a sensor or the clock, with a value and times."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from harness.samples import Sample

Readings = tuple[Sample, ...]
Effect = Callable[[Readings, int], Readings]  # what is sent at a tick [ns] for what was read
SensorAct = Callable[["Fault[SensorAct]", np.random.Generator], Effect]
A = TypeVar("A")


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


@dataclass(frozen=True)
class Kind(Generic[A]):
    """One kind of fault.

    Attributes:
        name, summary: As in --fault, and its line in the help.
        act: Of sensors: makes a fault's Effect for one run, to be asked at every tick. Of the clock:
            disturbs a FaultyClock at a tick, given the fault's value.
        takes: What may stand behind the '='; None for nothing.
        momentary: Whether it happens at one time, instead of lasting.
        own: The only sensors that can have it; empty if all can.
        of_values: Whether it changes values, which attitudes have too.
    """

    name: str
    summary: str
    act: A
    takes: Value | None = None
    momentary: bool = False
    own: tuple[str, ...] = ()
    of_values: bool = False


@dataclass(frozen=True)
class Fault(Generic[A]):
    """One fault of a run.

    Attributes:
        value: In the unit of what its kind takes; 0 if it takes none.
        start_ns: Simulation time of the first tick that it touches.
        end_ns: Simulation time from which it is over; None at the end of the run.
    """

    kind: Kind[A]
    sensor: str
    value: float
    start_ns: int
    end_ns: int | None

    def active(self, time_ns: int) -> bool:
        """Returns whether it touches a tick of that simulation time."""
        return self.start_ns <= time_ns and (self.end_ns is None or time_ns < self.end_ns)
