"""How all benchmarks measure: every contestant once per round, the median over the rounds."""

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Effort:
    """How long to measure."""

    rounds: int  # repeats of each measurement
    seconds: float  # simulated seconds of a run
    poses: int  # places from which a scan is taken in each round
    # how many of the lidar's maps, the small ones first, and at most as many rovers that learn
    maps: int
    hour: float  # what the memory benchmark calls an hour, in simulated seconds


FULL = Effort(rounds=5, seconds=60.0, poses=6, maps=3, hour=3600.0)
QUICK = Effort(rounds=1, seconds=2.0, poses=1, maps=2, hour=120.0)


@dataclass(frozen=True, kw_only=True)
class Table:
    """What a benchmark found: cells are text, the first column names the row."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


class Rounds:
    """Times [s] of contestants that took turns, so that a busy machine is busy for all."""

    def __init__(self, contestants: Mapping[str, Callable[[], float]], rounds: int) -> None:
        self._times: dict[str, list[float]] = {name: [] for name in contestants}
        for _ in range(rounds):
            for name, run in contestants.items():
                self._times[name].append(run())

    def median(self, name: str) -> float:
        """Median time of a contestant [s]."""
        return statistics.median(self._times[name])

    def ratio(self, slow: str, fast: str) -> float:
        """How many times longer one takes than the other: median of the rounds' ratios."""
        pairs = zip(self._times[slow], self._times[fast], strict=True)
        return statistics.median(a / b for a, b in pairs)


def timed(
    work: Callable[[], object], clock: Callable[[], float] = time.perf_counter
) -> Callable[[], float]:
    """Makes a contestant of something to do, by the wall's clock or the processor's."""

    def run() -> float:
        start = clock()
        work()
        return clock() - start

    return run


def against(ratio: float, goal: float) -> str:
    """Returns a ratio as a cell; one that is less than it must be says so."""
    return f"**{ratio:.2f}**" + (f" (short of {goal:.2f})" if ratio < goal else "")
