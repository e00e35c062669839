"""Lock-step with a MetricsNode in this process and with one in a process of its own."""

from benchmarks import ros_runs
from benchmarks.measuring import Effort, Rounds, Table
from harness.config import EpisodeConfig
from harness.episode.result import RunResult

TARGETS = {"in this process": ">= 10", "across processes (--wait-for)": ">= 8"}


def measure(effort: Effort) -> Table:
    """Speed, throughput and losses of both."""
    config = EpisodeConfig(duration=effort.seconds)
    results: dict[str, list[RunResult]] = {way: [] for way in TARGETS}

    def here() -> float:
        return _kept(results["in this process"], ros_runs.run(config))

    def across() -> float:
        with ros_runs.metrics_node():
            result = ros_runs.run(config, wait_for=(ros_runs.NODE,))
        return _kept(results["across processes (--wait-for)"], result)

    rounds = Rounds(dict(zip(TARGETS, (here, across), strict=True)), effort.rounds)
    return Table(
        title=f"Lock-step, {effort.seconds:g} simulated seconds of {config.robot} on {config.terrain}",
        columns=("metrics_node", "times real time", "target", "messages per second", "messages", "lost"),
        rows=tuple(
            (
                way,
                f"**{config.duration / rounds.median(way):.1f}**",
                target,
                f"{results[way][0].messages / rounds.median(way):,.0f}",
                f"{sum(r.messages for r in results[way]):,}",
                str(sum(r.lost for r in results[way])),
            )
            for way, target in TARGETS.items()
        ),
    )


def _kept(results: list[RunResult], result: RunResult) -> float:
    assert any(count.received for count in result.topics.values()), "nothing arrived"
    results.append(result)
    return result.wall_s
