"""Scores, summaries and ways against closed forms and other libraries."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import stats
from scipy.sparse import lil_array
from scipy.sparse.csgraph import dijkstra

from harness.course.planner import Planner
from harness.course.referee import Drive, Referee
from harness.course.result import penalty, score
from harness.course.summary import difference, mean_of, summarise
from harness.course.task import Rule, Task
from harness.episode.assembly import world_of
from harness.episode.batch import Batch
from harness.robots import find_rover
from harness.samples import Truth
from harness.spec.run import Run
from harness.world.grid import STEPS, distances, travel
from harness.world.world import build_world
from tests.harness.course.conftest import driven

TASK = Task(run=Run(), shortest=10.0, speed=0.5, rule=Rule())
DRIVE = Drive("reached", 1, 20.0, 0.0, 0.0, 0.0, Truth(path_length=10.0))


@pytest.mark.parametrize(
    ("time", "expected"), [(1.0, 1.0), (20.0, 1.0), (40.0, 0.5), (80.0, 0.25), (500.0, 0.25)]
)
def test_score_is_the_share_of_the_optimal_time_within_its_limits(time: float, expected: float) -> None:
    assert score(TASK, replace(DRIVE, time=time), 1.0) == expected


def test_penalties_halve_the_score_and_multiply() -> None:
    assert penalty(TASK, DRIVE, weight=50.0) == 1.0
    touched = replace(DRIVE, truth=Truth(hazard_contact_s=1.0))
    scraped = replace(touched, truth=replace(touched.truth, scrape_s=10.0))
    wasteful = replace(scraped, energy=6.0 * 50.0 * TASK.shortest)
    products = [penalty(TASK, drive, weight=50.0) for drive in (touched, scraped, wasteful)]
    assert products == pytest.approx([0.5, 0.25, 0.125])
    free = replace(TASK, rule=Rule(penalties=False))
    assert penalty(free, wasteful, weight=50.0) == 1.0


@pytest.mark.parametrize(
    ("truth", "failure", "ending"),
    [
        ({"hazard_contact_s": 0.1, "tipped_over": True, "position": (1.0, 0.0, 0.0)}, "", "contact"),
        ({"tipped_over": True, "position": (1.0, 0.0, 0.0)}, "", "tipped"),
        ({"time_ns": 10**12, "position": (1.0, 0.0, 0.0)}, "off the map", "reached"),
        ({"time_ns": 10**12, "position": (5.0, 0.0, 0.0)}, "off the map", "time"),
        ({"position": (5.0, 0.0, 0.0)}, "off the map", "off the map"),
        ({"position": (5.0, 0.0, 0.0)}, "", "time"),
    ],
)
def test_of_two_endings_the_graver_is_told(truth: dict[str, Any], failure: str, ending: str) -> None:
    run = Run.of(terrain="flat", driver="goal", route="1,0")
    referee = Referee(replace(TASK, run=run, rule=Rule(touch_ends=True)), world_of(run))
    referee.take(Batch((), Truth(**{"time_ns": 10**9} | truth), (), ()))
    told = referee.drive(failure)
    assert (told.ending, told.goals) == (ending, int(truth["position"][0] == 1.0))


def test_intervals_are_scipys() -> None:
    values = [0.24, 0.3, 0.5, 0.1, 0.4]
    mean = mean_of(values)
    low, high = stats.t.interval(0.95, 4, np.mean(values), stats.sem(values))
    assert (mean.low, mean.high) == pytest.approx((low, high), abs=1e-6)
    assert mean_of([0.0, 0.0]).low is None


def test_entries_are_paired_by_their_episodes() -> None:
    (first,) = driven("straight", "rocky", (1,))
    many = [replace(first, seed=seed, score=0.1 * seed) for seed in range(5)]
    better = [replace(one, score=one.score + 0.2) for one in reversed(many[1:])]
    paired = difference(many, better)
    assert paired is not None
    assert paired.mean == pytest.approx(0.2)
    assert difference(many, [replace(one, world_hash="other") for one in better]) is None


def test_a_track_is_as_quick_as_its_successes_and_as_risky_as_all_its_episodes() -> None:
    (one,) = driven("straight", "rocky", (1,))
    best = replace(one, ending="reached", time=10.0, goals=2, of_goals=3, risk_s=1.0)
    track = summarise([best, replace(best, ending="time", time=60.0, goals=0, risk_s=2.0)])
    assert (track.success.mean, track.seconds, track.risk_s_per_goal) == (0.5, 10.0, 1.5)


def test_distances_are_those_to_the_nearest_that_is_occupied_and_long_where_none_is() -> None:
    occupied = np.zeros((3, 5), bool)
    assert distances(occupied).min() > 1e5
    occupied[0, 1] = True
    assert distances(occupied)[2].tolist() == pytest.approx([5**0.5, 2.0, 5**0.5, 8**0.5, 13**0.5])


def test_ways_are_those_of_scipys_dijkstra() -> None:
    rng = np.random.default_rng(2)
    cost = np.where(rng.random((14, 17)) < 0.25, np.inf, 1.0 + rng.random((14, 17)))
    cost[3, 4] = 1.0
    rows, columns = cost.shape
    graph = lil_array((cost.size, cost.size))
    for row, column in np.ndindex(*cost.shape):
        for down, right in STEPS.tolist():
            r, c = row + down, column + right
            if not (0 <= r < rows and 0 <= c < columns) or not np.isfinite(
                cost[r, c] + cost[row, column]
            ):
                continue
            if abs(down) + abs(right) == 3:  # a knight's move crosses the two cells between
                a, b = (row + round(down / 3), column + round(right / 3)), (r, c)
                crossed = (a, (b[0] - round(down / 3), b[1] - round(right / 3)))
                if not all(np.isfinite(cost[cell]) for cell in crossed):
                    continue
            length = math.hypot(down, right) * 0.5 * (cost[r, c] + cost[row, column])
            graph[row * columns + column, r * columns + c] = length
    expected = dijkstra(graph.tocsr(), indices=3 * columns + 4).reshape(cost.shape)
    found = travel(cost, np.array([[3, 4]]), np.zeros(1), STEPS)
    reached = np.isfinite(cost)
    assert np.allclose(found[reached], expected[reached], rtol=1e-12)


def test_what_was_learned_beats_who_does_not_look() -> None:
    learned, straight = (driven(entry, "rocky", (1, 2)) for entry in ("learned", "straight"))
    assert sum(one.score for one in learned) > 2 * 0.1 + sum(one.score for one in straight)


def test_a_place_lies_in_the_cell_whose_middle_is_nearest() -> None:
    world = build_world("rolling", 1)
    planner, rng = Planner(world, find_rover("jackal")), np.random.default_rng(1)
    for x, y in rng.uniform(-0.9, 0.9, (200, 2)) * world.ground.half_size:
        middle = planner.middle(*planner.cell((x, y)))
        assert max(abs(middle[0] - x), abs(middle[1] - y)) < 0.0501
