"""Runs of scenarios against physics alone, and how many two processes drive in a minute."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from benchmarks.measuring import Effort, Rounds, Table, timed
from benchmarks.runs import physics, recorded
from harness.scenario.attempt import attempt
from harness.scenario.case import Case, plan
from harness.scenario.suite import run_all
from harness.workers import workers_of


class _Way(NamedTuple):
    """How scenarios are driven: `run` gives the wall time [s] of some runs on some processes."""

    name: str
    run: Callable[[], float]
    runs: int = 1
    processes: int = 1
    target: str = "-"


def measure(effort: Effort) -> Table:
    """Runs per minute in each way: one after another in this process, and a suite in two."""
    seconds, jobs = effort.seconds / 2, min(2, effort.rounds)
    with TemporaryDirectory() as folder:
        place = Path(folder)
        logged, *_ = _cases(place, seconds, "run.lost_messages: {max: 0}", 1)
        suite = _cases(place, seconds, "truth.tipped_over: {max: 0}", jobs * effort.rounds**2)
        commands = recorded(suite[0].run)
        ways = (
            _Way("physics alone", lambda: physics(suite[0].run, commands)),
            _Way("expectations of the truth", timed(lambda: attempt(suite[0], place))),
            _Way("expectations of the log", timed(lambda: attempt(logged, place))),
            _Way(
                f"of the truth, {jobs} processes",
                timed(lambda: run_all(suite, workers_of("local", jobs=jobs), place, lambda *_: None)),
                *(len(suite), jobs, ">= 100"),
            ),
        )
        rounds = Rounds({way.name: way.run for way in ways}, effort.rounds)
    return Table(
        title=f"Scenarios of {seconds:g} simulated seconds, leo wanders on rocky",
        columns=("way", "runs per minute", "target", "speed of a process against physics alone"),
        rows=tuple(
            (
                way.name,
                f"**{60 * way.runs / rounds.median(way.name):.0f}**",
                way.target,
                f"**{rounds.ratio(ways[0].name, way.name) * way.runs / way.processes:.2f}**",
            )
            for way in ways
        ),
    )


def _cases(folder: Path, seconds: float, expect: str, seeds: int) -> list[Case]:
    path = folder / "wander.scenario.yaml"
    path.write_text(
        f"about: Wanders.\nduration: {seconds}\nseeds: {seeds}\nexpect:\n  {expect}\n", encoding="utf-8"
    )
    return plan([path])
