"""Keeps a run from going faster than asked: `--rate 1.0` is real time, `max` does not wait."""

import time
from collections.abc import Callable

NANOSECONDS = 1_000_000_000


class Pacer:
    """Holds simulation time back to `rate` times wall time.

    Args:
        rate: Simulated seconds per wall second; None does not wait.
        clock: Monotonic wall clock in nanoseconds.
        sleep: Waits for seconds.
    """

    def __init__(
        self,
        rate: float | None,
        clock: Callable[[], int] = time.monotonic_ns,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._rate = rate
        self._clock, self._sleep = clock, sleep
        self._start_ns = clock()

    def postpone(self, seconds: float) -> None:
        """Lets simulation time be later by some wall time, in which it was to stand still."""
        self._start_ns += round(seconds * NANOSECONDS)

    def wait_until(self, simulation_ns: int) -> None:
        """Waits until wall time has caught up with a simulation time."""
        if self._rate is None:
            return
        due_ns = self._start_ns + round(simulation_ns / self._rate)
        remaining_ns = due_ns - self._clock()
        if remaining_ns > 0:
            self._sleep(remaining_ns / NANOSECONDS)
