"""The clock of a simulator that jumps, starts again, drifts, stands still or falls silent.

Jumps, resets and drift are the simulator's time itself: /clock and the stamps of all readings follow.
A frozen or silent /clock is the publisher's fault: the stamps go on.
"""

from collections.abc import Callable, Sequence

import numpy as np

from harness.base.sim_time import NANOSECONDS
from harness.faults.base import Fault

CLOCK = "clock"
LATEST_NS = (2**31 - 1) * NANOSECONDS  # a stamp's seconds have 31 bits

# Disturbs a clock at a tick, by the fault's value.
ClockAct = Callable[["FaultyClock", float, np.random.Generator], None]


class FaultyClock:
    """Call `advance` with the time of every tick, then read.

    Attributes:
        stamp_ns: What readings of this tick are stamped with.
        clock_ns: The time on /clock with this tick.
        is_sent: Whether /clock is sent with this tick.
        step_ns: By how much the stamps advance with this tick.
        frozen: Whether /clock repeats its last time.
    """

    def __init__(self, faults: Sequence[tuple[Fault[ClockAct], np.random.Generator]]) -> None:
        self._faults = faults
        self._time_ns = self.stamp_ns = self.clock_ns = 0
        self.step_ns = 0.0
        self.frozen, self.is_sent = False, True

    def advance(self, time_ns: int) -> None:
        """Goes on to a simulation time."""
        before_ns, self._time_ns = self._time_ns, time_ns
        self.step_ns = float(time_ns - before_ns)
        self.frozen, self.is_sent = False, True
        for fault, rng in self._faults:
            begins = before_ns < fault.start_ns <= time_ns
            if begins if fault.kind.momentary else fault.active(time_ns):
                fault.kind.act(self, fault.value, rng)
        self.stamp_ns = min(self.stamp_ns + round(self.step_ns), LATEST_NS)
        if not self.frozen:
            self.clock_ns = self.stamp_ns


def jump(clock: FaultyClock, seconds: float, _: np.random.Generator) -> None:
    """Moves the stamps [s], not below 0."""
    clock.stamp_ns = max(0, clock.stamp_ns + round(seconds * NANOSECONDS))


def reset(clock: FaultyClock, *_: object) -> None:
    """Starts the stamps again."""
    clock.stamp_ns = 0


def drift(clock: FaultyClock, factor: float, _: np.random.Generator) -> None:
    """Multiplies the step of this tick by a factor."""
    clock.step_ns *= factor


def freeze(clock: FaultyClock, *_: object) -> None:
    """Lets /clock tell its last time again."""
    clock.frozen = True


def silence(clock: FaultyClock, share: float, rng: np.random.Generator) -> None:
    """Keeps a share of /clock from being sent."""
    clock.is_sent &= rng.random() >= share
