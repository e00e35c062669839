"""Lock-step with a MetricsNode in this process, and with one and three in processes of their own."""

import statistics
from contextlib import ExitStack
from functools import partial

from benchmarks import ros_runs
from benchmarks.measuring import Effort, Rounds, Table, against
from harness.episode.result import RunResult
from harness.spec.run import Run

HERE = "one, in this process"
ELSEWHERE = {"one, in its process (--wait-for)": 1, "three, each in its process": 3}
GOALS = dict(zip((HERE, *ELSEWHERE), (1.0, 0.75, 0.45), strict=True))  # of the speed in one process


def measure(effort: Effort) -> Table:
    """Speed, throughput, losses, and how long the slowest node was waited for."""
    run = Run.of(duration=effort.seconds)
    results: dict[str, list[RunResult]] = {way: [] for way in GOALS}

    def here() -> float:
        return _kept(results[HERE], ros_runs.run(run))

    def across(way: str) -> float:
        names = tuple(f"metrics_node_{i}" for i in range(ELSEWHERE[way]))
        with ExitStack() as at_end:
            for name in names:
                at_end.enter_context(ros_runs.metrics_node(name))
            return _kept(results[way], ros_runs.run(run, wait_for=names))

    contestants = {HERE: here} | {way: partial(across, way) for way in ELSEWHERE}
    rounds = Rounds(contestants, effort.rounds)
    return Table(
        title=f"Lock-step, {effort.seconds:g} simulated seconds of {run.rover.robot} on "
        f"{run.world.terrain}",
        columns=(
            "metrics_node",
            "times real time",
            "speed against one process",
            "target",
            "messages per second",
            "messages",
            "lost",
            "waited for",
        ),
        rows=tuple(
            (
                way,
                f"{run.duration / rounds.median(way):.1f}",
                against(rounds.ratio(HERE, way), goal),
                "-" if way == HERE else f">= {goal:.2f}",
                f"{results[way][0].messages / rounds.median(way):,.0f}",
                f"{sum(r.messages for r in results[way]):,}",
                str(sum(r.lost for r in results[way])),
                _waited(results[way]),
            )
            for way, goal in GOALS.items()
        ),
    )


def _kept(results: list[RunResult], result: RunResult) -> float:
    assert any(count.received for count in result.topics.values()), "nothing arrived"
    results.append(result)
    return result.wall_s


def _waited(results: list[RunResult]) -> str:
    """The share of the runs in which the slowest node's answer was awaited."""
    shares = [max(r.waited_s.values()) / r.wall_s for r in results if r.waited_s]
    return f"{statistics.median(shares):.0%}" if shares else "-"
