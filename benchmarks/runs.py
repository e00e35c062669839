"""The same drive: physics alone, an episode with all sensors, through ROS 2 with and without /tf."""

import time
from unittest.mock import patch

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks import ros_runs
from benchmarks.measuring import Effort, Rounds, Table, against
from harness.episode.episode import Episode, episodes_of
from harness.episode.stream import EpisodeStream
from harness.episode.together import Together
from harness.robots import ROVERS
from harness.ros import session
from harness.spec.run import Run

Commands = list[NDArray[np.float64]]
PHYSICS, EPISODE = "physics alone", "episode with sensors"
ROS, WITHOUT_TF = "through ROS 2", "through ROS 2, without transforms"
GOALS = {EPISODE: 0.88, ROS: 0.80}  # of the speed of physics alone, at least


def measure(effort: Effort) -> Table:
    """Speed of each robot in these ways, on the default terrain."""
    rows: list[tuple[str, ...]] = []
    for robot in ROVERS:
        run = Run.of(robot=robot, duration=effort.seconds)
        rows += _rows(run, effort)
    return Table(
        title=f"The same drive in four ways, {effort.seconds:g} simulated seconds",
        columns=("robot", "way", "times real time", "speed against physics alone", "target", "lost"),
        rows=tuple(rows),
    )


def _rows(run: Run, effort: Effort) -> list[tuple[str, ...]]:
    commands = recorded(run)
    lost: list[int] = []

    def through_ros() -> float:
        result = ros_runs.run(run)
        lost.append(result.lost)
        return result.wall_s

    def without_transforms() -> float:
        with patch.object(
            session, "EpisodeStream", lambda run, _, **how: EpisodeStream(run, None, **how)
        ):
            return through_ros()

    ways = {
        PHYSICS: lambda: physics(run, commands),
        EPISODE: lambda: _episode(run),
        ROS: through_ros,
        WITHOUT_TF: without_transforms,
    }
    rounds = Rounds(ways, effort.rounds)
    cost = 1.0 - rounds.ratio(WITHOUT_TF, ROS)
    facts = {
        EPISODE: (f">= {GOALS[EPISODE]:.2f}", "-"),
        ROS: (f">= {GOALS[ROS]:.2f}", str(sum(lost))),
        WITHOUT_TF: (f"transforms cost {cost:.1%}, <= 3 %", str(sum(lost))),
    }
    return [
        (
            run.rover.robot,
            way,
            f"{run.duration / rounds.median(way):.1f}",
            against(rounds.ratio(PHYSICS, way), GOALS.get(way, 0.0)),
            *facts.get(way, ("-", "-")),
        )
        for way in ways
    ]


def recorded(run: Run) -> Commands:
    """Returns the wheel commands of an episode, tick by tick."""
    simulation = (episode := Episode(run)).simulation
    with patch.object(simulation, "command_ahead", wraps=simulation.command_ahead) as spy:
        for _ in episode.batches():
            pass
    return [speeds for call in spy.call_args_list for speeds in call.args[0]]


def physics(run: Run, commands: Commands) -> float:
    """Returns the wall time [s] of mj_step alone under these commands: same contacts, same path."""
    simulation = Episode(run).simulation
    start = time.perf_counter()
    for speeds in commands:
        simulation.command_wheels(speeds)
        mujoco.mj_step(simulation.model, simulation.data, simulation.steps_per_tick)
    return time.perf_counter() - start


def _episode(run: Run) -> float:
    episodes = episodes_of(run)
    start = time.perf_counter()
    for _ in Together(episodes, ahead=True, awake=True).batches():
        pass
    return time.perf_counter() - start
