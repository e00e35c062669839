"""The clock of a simulator that jumps, starts again, drifts, stands still or falls silent.

Jumps, resets and drift are the simulator's time itself: /clock and the stamps of all readings follow.
A frozen or silent /clock is the publisher's fault: the stamps go on.
"""

from collections.abc import Sequence

import numpy as np

from harness.faults.spec import Fault
from harness.sim_time import NANOSECONDS

LATEST_NS = (2**31 - 1) * NANOSECONDS  # a stamp's seconds have 31 bits


class FaultyClock:
    """Call `advance` with the time of every tick, then read.

    Attributes:
        stamp_ns: What readings of this tick are stamped with.
        told_ns: What /clock says with this tick.
        tells: Whether /clock says anything with this tick.
    """

    def __init__(self, faults: Sequence[tuple[Fault, np.random.Generator]]) -> None:
        self._faults = faults
        self._time_ns = 0
        self.stamp_ns = 0
        self.told_ns = 0
        self.tells = True

    def advance(self, time_ns: int) -> None:
        """Goes on to a simulation time."""
        step = float(time_ns - self._time_ns)
        frozen, self.tells = False, True
        for fault, rng in self._faults:
            if fault.kind in ("jump", "reset"):
                if self._time_ns < fault.start_ns <= time_ns:
                    self._jump(fault)
            elif fault.active(time_ns):
                if fault.kind == "speed":
                    step *= fault.value
                elif fault.kind == "freeze":
                    frozen = True
                else:
                    self.tells &= rng.random() >= fault.value
        self._time_ns = time_ns
        self.stamp_ns = min(self.stamp_ns + round(step), LATEST_NS)
        if not frozen:
            self.told_ns = self.stamp_ns

    def _jump(self, fault: Fault) -> None:
        ahead_ns = round(fault.value * NANOSECONDS)
        self.stamp_ns = 0 if fault.kind == "reset" else max(0, self.stamp_ns + ahead_ns)
