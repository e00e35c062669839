"""Runs of scenarios against physics alone, and how many two processes drive in a minute."""

import statistics
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from benchmarks.measuring import Effort, Rounds, Table, against, timed
from benchmarks.runs import Commands, physics, recorded
from harness.base.workers import workers_of
from harness.scenario.attempt import attempt
from harness.scenario.case import Case, plan
from harness.scenario.suite import run_all
from harness.spec.run import Run


class _Way(NamedTuple):
    """How scenarios are driven: `run` gives the wall time [s] of some runs on some processes."""

    name: str
    run: Callable[[], float]
    runs: int = 1
    processes: int = 1
    goal: float = 0.0  # of the speed of physics alone in as many processes


def measure(effort: Effort) -> Table:
    """Runs per minute in each way: one after another in this process, and a suite in two."""
    seconds, jobs = effort.seconds / 2, min(2, effort.rounds)
    bare = f"physics alone, {jobs} at once"
    with TemporaryDirectory() as folder:
        place = Path(folder)
        logged, *_ = _cases(place, seconds, "run.lost_messages: {max: 0}", 1)
        suite = _cases(place, seconds, "truth.tipped_over: {max: 0}", 4 * effort.rounds**2)
        commands = recorded(suite[0].run)
        ways = (
            _Way("physics alone", lambda: physics(suite[0].run, commands)),
            _Way("expectations of the truth", timed(lambda: attempt(suite[0], place))),
            _Way("expectations of the log", timed(lambda: attempt(logged, place))),
            _Way(bare, lambda: _at_once(suite[0].run, commands, jobs), jobs, jobs),
            _Way(
                f"{len(suite)} of the truth, {jobs} processes",
                timed(lambda: run_all(suite, workers_of("local", jobs=jobs), place, lambda *_: None)),
                *(len(suite), jobs, 0.75),
            ),
        )
        rounds = Rounds({way.name: way.run for way in ways}, effort.rounds)
    return Table(
        title=f"Scenarios of {seconds:g} simulated seconds, leo wanders on rocky",
        columns=("way", "runs per minute", "speed of a process against physics alone", "target"),
        rows=tuple(
            (
                way.name,
                f"**{60 * way.runs / rounds.median(way.name):.0f}**",
                _speed(rounds, way, bare if way.goal else ways[0].name),
                f">= {way.goal:.2f}" if way.goal else "-",
            )
            for way in ways
        ),
    )


def _speed(rounds: Rounds, way: _Way, beside: str) -> str:
    """A cell: how fast each of the processes is, against one that does physics alone."""
    return against(rounds.ratio(beside, way.name) * way.runs / way.processes, way.goal)


def _at_once(run: Run, commands: Commands, jobs: int) -> float:
    """The wall time [s] of physics alone in each of some processes at once."""
    with ProcessPoolExecutor(jobs, get_context("spawn")) as pool:
        return statistics.mean(pool.map(physics, [run] * jobs, [commands] * jobs))


def _cases(folder: Path, seconds: float, expect: str, seeds: int) -> list[Case]:
    path = folder / "wander.scenario.yaml"
    path.write_text(
        f"about: Wanders.\nduration: {seconds}\nseeds: {seeds}\nexpect:\n  {expect}\n", encoding="utf-8"
    )
    return plan([path])
