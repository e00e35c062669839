"""How fast episodes of a threshold sweep are driven, and what a second process buys."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.measuring import Effort, Rounds, Table, timed
from harness.base.workers import workers_of
from harness.robots import ROVERS
from harness.tune.episodes.plan import plan
from harness.tune.episodes.store import Store
from harness.tune.episodes.sweep import sweep

MOST_WORLDS, ROUNDS = 8, 3
TARGETS = {1: "-", 2: ">= 1.8"}


def measure(effort: Effort) -> Table:
    """Simulated seconds per second with one process and with two."""
    worlds = min(2 * effort.rounds, MOST_WORLDS)
    planned = plan(tuple(ROVERS), worlds, 0, effort.seconds)
    simulated: list[float] = []

    def driving(jobs: int) -> Callable[[], float]:
        def drive() -> None:
            with TemporaryDirectory() as folder, workers_of("local", jobs=jobs) as workers:
                store = Store(Path(folder), planned)
                records = sweep(planned, store, workers, lambda _: None)
            simulated.append(sum(record.duration for record in records.values()))

        return timed(drive)

    contestants = {str(jobs): driving(jobs) for jobs in TARGETS}
    rounds = Rounds(contestants, min(effort.rounds, ROUNDS))
    return Table(
        title=f"Episodes of a threshold sweep: {len(planned)} of {effort.seconds:g} simulated seconds",
        columns=("processes", "simulated seconds per second", "speed against one", "target"),
        rows=tuple(
            (
                str(jobs),
                f"**{simulated[-1] / rounds.median(str(jobs)):.0f}** (>= 40)",
                f"**{rounds.ratio('1', str(jobs)):.2f}**",
                target,
            )
            for jobs, target in TARGETS.items()
        ),
    )
