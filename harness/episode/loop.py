"""The loop that drives an episode, and the account of a run that it keeps.

A run through ROS, one without, a trial and an episode of a sweep are this loop with another sink and
other observers.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

from harness.episode.batch import Batch
from harness.episode.result import Progress, RunResult
from harness.episode.truth_account import TruthAccount
from harness.faults.injector import FaultInjector
from harness.interrupt import StopRequest
from harness.samples import Tick

Sink = Callable[[Tick, Tick], None]  # takes a tick of the episode, and what listeners get of it


class Observer(Protocol):
    """A consumer of the batches of an episode: account, report, recorder, verdict."""

    def take(self, batch: Batch) -> None:
        """Takes the next batch, after its ticks have gone to the sink."""
        ...


def drive(
    batches: Iterable[Batch],
    faults: FaultInjector,
    sink: Sink,
    observers: Sequence[Observer] = (),
    stop: StopRequest | None = None,
) -> Iterator[Tick]:
    """Hands each tick to the sink, as the faults leave it, and then each batch to the observers.

    Args:
        batches: Of the episode.
        faults: Act on what leaves the rover; the episode itself does not see them.
        sink: Where ticks go.
        observers: See every batch, in this order.
        stop: Ends the drive after the batch in which it is requested.

    Yields:
        Each tick of the episode, once the sink has taken it.
    """
    for batch in batches:
        for tick in batch.ticks:
            sink(tick, faults.corrupt(tick))
            yield tick
        for observer in observers:
            observer.take(batch)
        if stop is not None and stop.signal is not None:
            return


@dataclass
class RunAccount:
    """An observer that keeps a run's result up to date and tells how far it is.

    Args:
        started: Wall time at which the command began [s], of time.monotonic; `began` is that of the
            first batch.
        show: Is told the progress after every batch.
        messages: Counts the messages published so far; `rows` counts those of the CSV.
        paused_s: Wall time for which the run was paused so far [s].

    Attributes:
        result: What the run has come to up to now.
    """

    result: RunResult
    started: float
    show: Callable[[Progress], None]
    messages: Callable[[], int]
    rows: Callable[[], int]
    paused_s: Callable[[], float] = float
    began: float = field(init=False)
    _truth: TruthAccount = field(default_factory=TruthAccount)

    def __post_init__(self) -> None:
        self.began = time.monotonic()

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        self._truth.take(batch)
        now, paused_s, result = time.monotonic(), self.paused_s(), self.result
        first_row_s = result.first_row_s
        if first_row_s is None and self.rows():
            first_row_s = now - self.started
        self.result = replace(
            result,
            truth=batch.truth,
            wall_s=now - self.began - paused_s,
            paused_s=paused_s,
            first_row_s=first_row_s,
        )
        self.show(self._progress())

    def ended(self, *, failure: str | None = None, interrupted: str | None = None) -> RunResult:
        """The result of the whole run, with what it met on its way and why it ended early, if it did."""
        return replace(self.result, along=self._truth.along(), failure=failure, interrupted=interrupted)

    def _progress(self) -> Progress:
        result = self.result
        return Progress(
            simulated_s=result.simulated_s,
            total_s=result.config.duration,
            wall_s=result.wall_s,
            path_length=result.truth.path_length,
            messages=self.messages(),
        )
