"""The clock of a simulator that jumps, starts again, drifts, stands still or falls silent.

Jumps, resets and drift are the simulator's time itself: /clock and the stamps of all readings follow.
A frozen or silent /clock is the publisher's fault: the stamps go on.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.faults.base import SHARE, Fault, Value
from harness.faults.readings import StampShift
from harness.sim_time import NANOSECONDS

CLOCK = "clock"
LATEST_NS = (2**31 - 1) * NANOSECONDS  # a stamp's seconds have 31 bits


class ClockFault(Fault):
    """A fault of the clock: `_disturb` acts on a tick that it touches."""

    own = (CLOCK,)

    def apply(self, clock: "FaultyClock", rng: np.random.Generator) -> None:
        """Acts on the present tick of a clock, if it touches it."""
        begins = clock.before_ns < self.start_ns <= clock.time_ns
        if begins if self.momentary else self.active(clock.time_ns):
            self._disturb(clock, rng)

    def _disturb(self, clock: "FaultyClock", rng: np.random.Generator) -> None:
        raise NotImplementedError


class FaultyClock:
    """Call `advance` with the time of every tick, then read.

    Attributes:
        stamp_ns: What readings of this tick are stamped with.
        told_ns: What /clock says with this tick.
        tells: Whether /clock says anything with this tick.
        time_ns: Simulation time of this tick without faults; `before_ns` is that of the tick before.
        step_ns: By how much the stamps advance with this tick.
        frozen: Whether /clock repeats its last time.
    """

    def __init__(self, faults: Sequence[tuple[ClockFault, np.random.Generator]]) -> None:
        self._faults = faults
        self.time_ns = self.before_ns = self.stamp_ns = self.told_ns = 0
        self.step_ns = 0.0
        self.frozen, self.tells = False, True

    def advance(self, time_ns: int) -> None:
        """Goes on to a simulation time."""
        self.before_ns, self.time_ns = self.time_ns, time_ns
        self.step_ns = float(time_ns - self.before_ns)
        self.frozen, self.tells = False, True
        for fault, rng in self._faults:
            fault.apply(self, rng)
        self.stamp_ns = min(self.stamp_ns + round(self.step_ns), LATEST_NS)
        if not self.frozen:
            self.told_ns = self.stamp_ns


class ClockJump(ClockFault):
    """Time goes S ahead or back, not below 0, and on from there."""

    name, takes, momentary = "jump", replace(StampShift.takes, default=10.0), True

    def _disturb(self, clock: FaultyClock, _: np.random.Generator) -> None:
        clock.stamp_ns = max(0, clock.stamp_ns + round(self.value * NANOSECONDS))


class ClockReset(ClockFault):
    """Time starts again from 0."""

    name, momentary = "reset", True

    def _disturb(self, clock: FaultyClock, _: np.random.Generator) -> None:
        clock.stamp_ns = 0


class ClockSpeed(ClockFault):
    """Time runs FACTOR as fast, for stamps too."""

    name = "speed"
    takes = Value("FACTOR", "a factor above 0 up to 100", lambda x: 0.0 < x <= 100.0)

    def _disturb(self, clock: FaultyClock, _: np.random.Generator) -> None:
        clock.step_ns *= self.value


class ClockFreeze(ClockFault):
    """/clock repeats its last time, then catches up."""

    name = "freeze"

    def _disturb(self, clock: FaultyClock, _: np.random.Generator) -> None:
        clock.frozen = True


class ClockDropout(ClockFault):
    """/clock is not sent."""

    name, takes = "dropout", SHARE

    def _disturb(self, clock: FaultyClock, rng: np.random.Generator) -> None:
        clock.tells &= rng.random() >= self.value
