"""Track mission: its places by geodesy, its rules by rovers that are carried along its way."""

import math
from itertools import combinations, pairwise
from pathlib import Path

import pytest
from pymap3d import geodetic2enu

from harness.course.task import Case
from harness.course.tracks import find_track
from harness.episode.assembly import world_of
from harness.spec.world import DEFAULT_DATUM
from harness.world.geodesy import Datum
from harness.world.route import RouteProgress, marks

SEEDS = (0, 7, 31)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_stop_at_the_coordinates_is_one_within_two_metres_of_the_post(
    seed: int, tmp_path: Path
) -> None:
    task = find_track("mission").task(Case("mission", seed), tmp_path)
    world, route = world_of(task.run), task.run.plan.route
    assert route is not None
    first, gate, last = world.targets
    for point, post in ((route.points[0], first), (route.points[2], last)):
        east, north, _ = geodetic2enu(point.lat, point.lon, DEFAULT_DATUM[2], *DEFAULT_DATUM)
        assert math.dist((east, north), post.position[:2]) + point.radius < 2.0
        assert point.stop
    assert math.dist(*gate.posts) == pytest.approx(2.0)
    way = [(0.0, 0.0), *(target.position[:2] for target in (first, gate, last))]
    stops = [(0.0, 0.0), *(mark.place for mark in marks(route, world.targets, Datum(*DEFAULT_DATUM)))]
    assert min(math.dist(*pair) for pair in combinations(stops, 2)) > 5.0 - 1e-3
    assert max(math.dist(*pair) for pair in pairwise(stops)) < 8.0 + 1e-3
    assert task.shortest > sum(math.dist(a, b) for a, b in pairwise(way)) - 4 * 1.2
    assert task.optimal == pytest.approx(task.shortest / 2.0, rel=0.03)


def test_posts_are_stopped_at_and_the_gate_is_passed_in_this_order(tmp_path: Path) -> None:
    task = find_track("mission").task(Case("mission", 0), tmp_path)
    route, targets = task.run.plan.route, world_of(task.run).targets
    assert route is not None
    first, gate, last = places = marks(route, targets, Datum(*DEFAULT_DATUM))
    cos, sin = math.cos(targets[1].yaw), math.sin(targets[1].yaw)

    def at_gate(along: float, left: float) -> tuple[float, float, float]:
        x, y = gate.place
        return x + along * cos - left * sin, y + along * sin + left * cos, 0.0

    def reached(*way: tuple[float, float, float]) -> list[int]:
        progress, time = RouteProgress(places), 0.0
        for x, y, seconds in way:
            for _ in range(max(1, round(seconds / 0.05))):
                time += 0.05
                progress.observe(time, (x, y))
        return list(progress.reached)

    a, b, c, d = (*first.place, 1.2), at_gate(-0.3, 0.0), at_gate(0.3, 0.0), (*last.place, 1.2)
    assert reached(a, b, c, d) == [0, 1, 2]
    assert reached((*first.place, 0.5), b, c, d) == []  # did not stop
    assert reached(a, at_gate(-0.3, 1.5), at_gate(0.3, 1.5)) == [0]  # beside the gate
    assert reached(d, b, c, a) == [0]  # in another order
