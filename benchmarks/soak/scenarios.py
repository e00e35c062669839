"""The scenarios: long runs, a node that is stopped, many nodes, a machine with other work."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from benchmarks.resident import Growth
from benchmarks.soak.drive import drive
from benchmarks.soak.listeners import Competition, Listener, Stutter, metrics_nodes, waiting_for
from benchmarks.soak.outcome import Outcome
from benchmarks.soak.plan import Plan

HEARD = 4  # topics that a metrics node listens to, /clock apart
CORES = 2  # of the starved run: it has two processes
RIVALS_PER_CORE = 4  # leave it a fifth

Scenario = Callable[[Plan, "Reference", Path], Outcome]


class Reference:
    """The log of the same drive with the same faults, written without ROS and undisturbed."""

    def __init__(self, plan: Plan, folder: Path) -> None:
        logs = folder / "logs"
        drive([*plan.words(plan.longest), "--direct", "--log-dir", str(logs)], folder, _do_nothing)
        self._lines = _log(logs).splitlines(keepends=True)

    def agrees(self, log: bytes, seconds: int) -> bool:
        """Whether a log of so many simulated seconds has its bytes."""
        return log == b"".join(self._lines[: 1 + seconds])


def long_run_in_one_process(plan: Plan, reference: Reference, folder: Path) -> Outcome:
    """Hours with a hosted metrics node."""
    logs = folder / "logs"
    growth = Growth(logs, plan.long)
    told = drive([*plan.words(plan.long), "--log-dir", str(logs)], folder, growth.look)
    return _outcome("metrics_node hosted", plan.long, told, [_log(logs)], reference, growth)


def long_run_across_processes(plan: Plan, reference: Reference, folder: Path) -> Outcome:
    """Hours with a metrics node in a process of its own."""
    with metrics_nodes(1, folder) as listeners:
        (node,) = listeners
        growth = Growth(node.logs, plan.long, {"metrics_node": node.process})
        told = drive(_elsewhere(plan, plan.long, listeners), folder, growth.look)
    logs = [_log(node.logs)]
    return _outcome("metrics_node in a process of its own", plan.long, told, logs, reference, growth)


def stopped_node(plan: Plan, reference: Reference, folder: Path) -> Outcome:
    """A metrics node that is stopped (SIGSTOP) half of the time."""
    with metrics_nodes(1, folder) as listeners:
        (node,) = listeners
        stutter = Stutter(node.process)
        told = drive(_elsewhere(plan, plan.stopped, listeners), folder, lambda _: stutter.look())
    name = f"its process stopped and continued {stutter.stops} times"
    return _outcome(name, plan.stopped, told, [_log(node.logs)], reference)


def many_nodes(plan: Plan, reference: Reference, folder: Path) -> Outcome:
    """Metrics nodes in many processes, subscribed at once."""
    with metrics_nodes(plan.nodes, folder) as listeners:
        told = drive(_elsewhere(plan, plan.many, listeners), folder, _do_nothing)
    logs = [_log(node.logs) for node in listeners]
    return _outcome(f"{plan.nodes} nodes at once", plan.many, told, logs, reference)


def starved(plan: Plan, reference: Reference, folder: Path) -> Outcome:
    """A run that gets a fifth of its processors: many others want them, too."""
    logs = folder / "logs"
    with _few_cores() as cores, Competition(RIVALS_PER_CORE * cores, logs) as rivals:
        words = [*plan.words(plan.starved), "--log-dir", str(logs)]
        told = drive(words, folder, lambda _: rivals.look())
    name = f"hosted, starved to a fifth: {RIVALS_PER_CORE * cores} busy processes on its {cores} cores"
    return _outcome(name, plan.starved, told, [_log(logs)], reference)


SCENARIOS: tuple[Scenario, ...] = (
    long_run_in_one_process,
    long_run_across_processes,
    stopped_node,
    many_nodes,
    starved,
)


def _outcome(
    name: str,
    seconds: int,
    told: dict[str, Any],
    logs: list[bytes],
    reference: Reference,
    growth: Growth | None = None,
) -> Outcome:
    return Outcome(
        scenario=name,
        seconds=seconds,
        failure=_failure(told),
        speed=_speed(told),
        messages=sum(count["published"] for count in told["topics"].values()),
        lost=told["lost"],
        rows=tuple(log.count(b"\n") - 1 for log in logs),
        same=all(reference.agrees(log, seconds) for log in logs),
        grown=growth.grown if growth else {},
    )


def _speed(told: dict[str, Any]) -> float:
    return float(told["real_time_factor"])


def _failure(told: dict[str, Any]) -> str | None:
    if told["outcome"]["status"] != "complete":
        return f"{told['outcome']['status']}: {told['outcome']['reason']}"
    heard = [topic for topic, count in told["topics"].items() if count["received"] is not None]
    return None if len(heard) >= HEARD else "nobody counted what arrived"


def _elsewhere(plan: Plan, seconds: int, listeners: list[Listener]) -> list[str]:
    return [*plan.words(seconds), *waiting_for(listeners)]


@contextmanager
def _few_cores() -> Iterator[int]:
    """Keeps what is started within to as few cores as a run can use; gives how many those are."""
    before = os.sched_getaffinity(0)
    few = sorted(before)[:CORES]
    os.sched_setaffinity(0, few)
    try:
        yield len(few)
    finally:
        os.sched_setaffinity(0, before)


def _log(folder: Path) -> bytes:
    (log,) = folder.glob("*.csv")
    return log.read_bytes()


def _made(folder: Path) -> Path:
    folder.mkdir()
    return folder


def _do_nothing(_: int) -> None:
    """Nothing is looked at."""
