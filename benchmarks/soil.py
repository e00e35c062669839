"""Physics on soil against rigid ground: the same rover under the same commands on the same terrain."""

import time
from collections.abc import Callable

import mujoco
import numpy as np

from benchmarks.measuring import Effort, Rounds, Table, timed
from harness.base.sim_time import TICK_NS
from harness.episode.episode import Episode
from harness.physics.base_controller import base_controller
from harness.robots import ROVERS
from harness.samples import Twist
from harness.spec.run import Run

TERRAINS = ("rocky", "gravel")
GROUNDS = {"rigid ground": "", "firm": "firm", "dry_sand": "dry_sand"}
SPEED, TURN = 0.4, 0.3  # [m/s], [rad/s] in curves to either side
CURVE = 200  # [ticks]
TARGET = ">= 1.3, aim 1.8"


def measure(effort: Effort) -> Table:
    """Steps per second of each rover on each ground, by the processor's time."""
    rows: list[tuple[str, ...]] = []
    for terrain in TERRAINS:
        for robot in ROVERS:
            drives = {name: _drive(terrain, robot, soil, effort) for name, soil in GROUNDS.items()}
            rounds = Rounds(drives, effort.rounds)
            rigid, *soils = GROUNDS
            rows.append((f"{robot} on {terrain}", rigid, _steps(rounds, rigid, effort), "-", "-"))
            for soil in soils:
                faster = f"**{rounds.ratio(rigid, soil):.2f}**"
                rows.append(
                    (f"{robot} on {terrain}", soil, _steps(rounds, soil, effort), faster, TARGET)
                )
    return Table(
        title="Physics on soil",
        columns=("drive", "ground", "steps per second", "times as fast as rigid ground", "target"),
        rows=tuple(rows),
    )


def _seconds(effort: Effort) -> float:
    return round(effort.seconds / 3, 2)  # whole ticks


def _steps(rounds: Rounds, ground: str, effort: Effort) -> str:
    return f"{_seconds(effort) * 400 / rounds.median(ground):,.0f}"


def _drive(terrain: str, robot: str, soil: str, effort: Effort) -> Callable[[], float]:
    run = Run.of(terrain=terrain, robot=robot, soil=soil, duration=_seconds(effort))
    simulation = Episode(run).simulation
    controller = base_controller(simulation.scene.rover, TICK_NS * 1e-9)
    rng, ticks = np.random.default_rng(0), round(_seconds(effort) / (TICK_NS * 1e-9))
    twists = [Twist(SPEED, float(turn)) for turn in rng.uniform(-TURN, TURN, ticks // CURVE + 1)]

    def drive() -> None:
        simulation.return_to_start()
        for tick in range(ticks):
            if tick % CURVE == 0:
                controller.command(twists[tick // CURVE])
            simulation.command_wheels(controller.wheel_speeds())
            mujoco.mj_step(simulation.model, simulation.data, simulation.steps_per_tick)

    return timed(drive, time.process_time)
