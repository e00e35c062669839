"""The benchmarks by name. Each is a module of this package with `measure(effort) -> Table`."""

import os
from dataclasses import dataclass, replace
from importlib import import_module

from benchmarks.measuring import Effort, Table


@dataclass(frozen=True, slots=True)
class Benchmark:
    """One subject."""

    name: str  # of its module
    question: str  # what its table answers
    takes_minutes: bool = False  # whether it is left out unless asked for

    def measure(self, effort: Effort) -> Table:
        """Its table, with the load at its start; it says why if something that it needs is missing."""
        try:
            module = import_module(f"benchmarks.{self.name}")
        except ImportError as error:
            return Table(title=self.name, columns=("skipped",), rows=((str(error),),))
        load, _, _ = os.getloadavg()
        table: Table = module.measure(effort)
        return replace(table, title=f"{table.title}; load average {load:.1f}")


BENCHMARKS = {
    benchmark.name: benchmark
    for benchmark in (
        Benchmark("lidar", "a scan against mj_multiRay and PyBullet: cost, hits, parity"),
        Benchmark("growth", "what a scan costs with map size, cell size and beams"),
        Benchmark("sensors", "optional lidars and depth camera: rays a second, runs with each"),
        Benchmark("runs", "physics alone, episode with sensors, run through ROS 2: speed"),
        Benchmark("ticks", "where the time of an episode goes: MuJoCo, sensors, driver"),
        Benchmark("lockstep", "lock-step in one process and across two: speed, messages, losses"),
        Benchmark("obstacles", "steps per second against the number of obstacles"),
        Benchmark("soil", "physics on soil against rigid ground, the same drive"),
        Benchmark("gym", "learning environments: steps a second alone and many at once, resets"),
        Benchmark("tuning", "episodes of a threshold sweep: speed with one process and with two"),
        Benchmark("scenarios", "runs of scenarios per minute, and against physics alone"),
        Benchmark("start", "from the command to the first CSV row"),
        Benchmark("memory", "growth over a simulated hour", takes_minutes=True),
    )
}
