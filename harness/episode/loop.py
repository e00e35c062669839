"""The loop that drives an episode, and what keeps it from going faster than asked.

A run through ROS, one without, a trial and an episode of a sweep are this loop with another sink and
other observers.
"""

import time
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Protocol

from harness.base.errors import PluginFailed
from harness.base.interrupt import StopRequest
from harness.base.sim_time import NANOSECONDS
from harness.episode.batch import Batch
from harness.faults.injector import FaultInjector
from harness.samples import Tick
from rover_metrics.errors import KnownError
from rover_metrics.plugins import blamed

Sink = Callable[[Tick, Tick], None]  # takes a tick of the episode, and what listeners get of it


class Observer(Protocol):
    """A consumer of the batches of an episode: account, report, recorder, verdict."""

    def take(self, batch: Batch) -> None:
        """Takes the next batch, after its ticks have gone to the sink."""
        ...


@dataclass(frozen=True)
class Route:
    """Where the ticks and the batches of one rover go.

    Attributes:
        faults: Act on what leaves the rover; the episode itself does not see them.
        observers: See every batch, in this order.
    """

    faults: FaultInjector
    sink: Sink
    observers: Sequence[Observer] = ()


def drive(
    batches: Generator[Sequence[Batch]],
    routes: Sequence[Route],
    stop: StopRequest | None = None,
    meanwhile: Callable[[], None] = lambda: None,
) -> Generator[Tick]:
    """Hands each rover's tick to its sink, as its faults leave it, then its batches to its observers.

    Args:
        batches: Of each control period, one per rover; closed at the end, whatever it is.
        routes: Of the rovers, in their order.
        stop: Ends the drive after the batch in which it is requested.
        meanwhile: Is called after each tick, while the next batches are being made.

    Yields:
        Each tick of the first rover, once the sinks have taken those of all.

    Raises:
        RunFailed: As the episode does; PluginFailed: a plug-in of a user has raised anything.
    """
    now_ns = 0
    try:
        with closing(batches):  # a second core may be at the next ones
            for period in batches:
                for ticks in zip(*(batch.ticks for batch in period), strict=True):
                    for tick, route in zip(ticks, routes, strict=True):
                        route.sink(tick, route.faults.corrupt(tick))
                    now_ns = ticks[0].stamp_ns
                    meanwhile()
                    yield ticks[0]
                for batch, route in zip(period, routes, strict=True):
                    for observer in route.observers:
                        observer.take(batch)
                if stop is not None and stop.signal is not None:
                    return
    except KnownError:
        raise
    except (Exception, SystemExit) as error:  # whatever a plug-in raises
        if reason := blamed(error):
            now = now_ns / NANOSECONDS
            raise PluginFailed(f"a plug-in failed after {now:.2f} s: {reason}") from error
        raise


class Pacer:
    """Holds simulation time back to `rate` times wall time: 1.0 is real time.

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
        self._rate, self._clock, self._sleep = rate, clock, sleep
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
