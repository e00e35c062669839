"""How fast the physics steps among more and more obstacles."""

from collections.abc import Callable

import mujoco
import numpy as np

from benchmarks.measuring import Effort, Rounds, Table, timed
from benchmarks.scenes import TIMESTEP, scene_on_hills
from harness.base.sim_time import NANOSECONDS
from harness.physics.simulation import Simulation

COUNTS = (0, 10, 100, 1000)
MAP_SIZE, CELL, HILL_HEIGHT = 40.0, 0.1, 0.2  # [m]: gentle enough to be driven over
WHEEL_SPEEDS = np.array([4.0, 4.0, 8.0, 8.0])  # [rad/s]: a left turn


def measure(effort: Effort) -> Table:
    """Steps per second by number of obstacles, a rover driving in circles."""
    steps = round(effort.seconds / 4 / TIMESTEP)
    rounds = Rounds({str(count): _driving(count, steps) for count in COUNTS}, effort.rounds)
    return Table(
        title="Physics among obstacles",
        columns=("obstacles", "steps per second", "time against none"),
        rows=tuple(
            (
                str(count),
                f"{steps / rounds.median(str(count)):,.0f}",
                f"**{rounds.ratio(str(count), str(COUNTS[0])):.2f}**",
            )
            for count in COUNTS
        ),
    )


def _driving(count: int, steps: int) -> Callable[[], float]:
    scene = scene_on_hills(MAP_SIZE, CELL, count, HILL_HEIGHT)
    simulation = Simulation(scene, round(TIMESTEP * NANOSECONDS))
    start = simulation.data.qpos.copy()

    def drive() -> None:
        mujoco.mj_resetData(simulation.model, simulation.data)
        simulation.data.qpos[:] = start
        simulation.command_wheels(WHEEL_SPEEDS)
        mujoco.mj_step(simulation.model, simulation.data, steps)

    return timed(drive)
