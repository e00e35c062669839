"""The driver that goes where it is said."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.drivers.base import DriverContext, Observation
from harness.drivers.goal import Goal
from harness.episode.episode import Episode
from harness.samples import Place, Twist
from harness.spec.run import Run
from tests.support.rovers import LEO


def driver() -> Goal:
    return Goal(DriverContext(LEO, (20.0, 20.0), np.zeros(1), np.random.default_rng(0)))


HERE = Observation(0, 1.0, 2.0, 0.5, None)


def test_it_stands_before_the_first_goal_and_then_is_not_stuck() -> None:
    goal, origin = driver(), Observation(0, 0.0, 0.0, 0.0, None)
    assert goal.command(origin) == Twist()
    goal.head_for(5.0, 0.0, 0.0)
    assert goal.command(replace(origin, time_ns=60_000_000_000)) == Twist(LEO.cruise_speed, 0.0)


@pytest.mark.parametrize(
    ("yaw", "rate"),
    [(0.5, 0.0), (0.59, 0.0), (0.3, -0.4), (0.8, 0.6), (3.0, 1.0), (0.5 - math.pi + 0.1, -1.0)],
)
def test_at_the_goal_it_turns_to_the_goals_heading_the_short_way(yaw: float, rate: float) -> None:
    goal = driver()
    goal.head_for(1.2, 2.1, yaw)
    assert goal.command(HERE).linear == 0.0
    assert goal.command(HERE).angular == pytest.approx(rate * LEO.cruise_yaw_rate)
    drifted = replace(HERE, x=0.8)
    assert goal.command(drifted).linear == 0.0, "what it has reached it does not leave"


@pytest.mark.parametrize("robot", ["leo", "rover_zero4wd"])
def test_it_reaches_goals_among_obstacles_by_its_lidar(robot: str) -> None:
    episode = Episode(
        Run.of(
            terrain="posts", robot=robot, driver="goal", duration=60.0, lidar_beams=90, timestep=0.005
        )
    )
    goals, reached = [Place(3.0, 1.0, 1.5), Place(0.5, 2.5, -2.0)], 0
    episode.pilot.head_for(goals[0])
    for _ in episode.batches():
        (x, y, _), goal = episode.simulation.position, goals[reached]
        turn = math.remainder(goal.yaw - episode.simulation.yaw, math.tau)
        if math.dist((x, y), (goal.x, goal.y)) < 0.35 and abs(turn) < 0.2:
            reached += 1
            if reached == len(goals):
                break
            episode.pilot.head_for(goals[reached])
    assert reached == len(goals)
    assert episode.simulation.time_ns < 50e9
