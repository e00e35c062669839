"""People in a world: ways that are refused, and walkers that keep their promises."""

import math
from itertools import pairwise
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

from harness.errors import UsageError
from harness.world.actors.actor import with_actors
from harness.world.actors.room import Room
from harness.world.actors.route import Route
from harness.world.actors.social_force import step
from harness.world.actors.spec import parse_actors
from harness.world.actors.stroll import Stroll, StrollRoute
from harness.world.actors.walker import SocialWalker
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, outline
from harness.world.world import World, terrain_hash

WALL = Obstacle(ObstacleKind.HAZARD, "box", (0.2, 1.0, 0.5), (3.0, 0.0, 0.5))
BARE = World("bare", Heightfield(np.zeros((201, 201)), 0.1), (WALL,), seed=3, difficulty=0.0)
TICK_S = 0.01


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("g=0,0/6,0", r"actor 'g' walks through hazard_0 at 2\.60,0\.00; lead it around"),
        ("g=0,0/0,9.6", r"actor 'g' walks off the map at 0\.00,9\.60; .* y from -9\.5 to 9\.5 m"),
        ("g=0,2/6,2/6,-2:route=closed", "walks through hazard_0"),
        ("g=random:within=2", "actor 'g': no free place within 2 m of the rover's start at 0,0"),
    ],
)
def test_ways_without_room_are_refused_with_the_place(text: str, told: str) -> None:
    with pytest.raises(UsageError, match=told):
        with_actors(BARE, parse_actors([text]))


def test_a_random_walk_is_straight_free_steady_and_the_names_own() -> None:
    both = with_actors(BARE, parse_actors(["a=random:speed=2,within=7", "b=random:within=7"])).people
    alone = with_actors(BARE, parse_actors(["b=random:within=7"])).people
    ways = [actor.way() for actor in (*both, *alone)]
    times = np.arange(0.0, 300.0, 0.5)
    places = np.array(
        [
            [(p.x, p.y) for t in times for p in [way.place(t)]]
            for way in ways
            if isinstance(way, StrollRoute)
        ]
    )
    np.testing.assert_array_equal(places[1], places[2])
    late = both[0].way()
    assert isinstance(late, StrollRoute)
    assert late.place(299.5).x == places[0, -1, 0]  # whatever was asked before
    steps = np.linalg.norm(np.diff(places, axis=1), axis=2)
    assert (steps <= [[1.0 + 1e-9], [0.5 + 1e-9], [0.5 + 1e-9]]).all()
    assert np.median(steps, axis=1) == pytest.approx([1.0, 0.5, 0.5])
    assert np.linalg.norm(places, axis=2).max() <= 7.0
    assert Room(BARE).trouble(places.reshape(-1, 2), 0.25 - 1e-6) is None
    assert math.hypot(*both[0].begin) > 2.0


def social(text: str = "s=social:within=6") -> SocialWalker:
    way = with_actors(BARE, parse_actors([text])).people[0].way()
    assert isinstance(way, SocialWalker)
    return way


def heading_for(x: float, y: float) -> SocialWalker:
    """One at the origin that walks there at 1 m/s."""
    stroll = Mock()
    stroll.spot.side_effect = [(0.0, 0.0), (x, y)].__getitem__
    return SocialWalker(stroll, Room(BARE), speed=1.0, delay=0.0, radius=0.25)


def walked(walker: SocialWalker, seconds: float, bodies: list[tuple[float, float, float]]) -> np.ndarray:
    ticks = range(1, round(seconds / TICK_S) + 1)
    return np.array([(p.x, p.y) for n in ticks for p in [walker.walk(n * TICK_S, TICK_S, bodies)]])


def test_a_social_walker_alone_walks_at_its_speed_and_again_after_a_restart() -> None:
    walker = social()
    first = walked(walker, 12.0, [])
    walker.restart()
    np.testing.assert_array_equal(walked(walker, 12.0, []), first)
    steps = np.linalg.norm(np.diff(first, axis=0), axis=1) / TICK_S
    assert steps.max() <= 1.3 + 1e-9
    assert np.median(steps) == pytest.approx(1.0, abs=0.02)
    assert Room(BARE).trouble(first, 0.25 - 1e-6) is None


def test_a_social_walker_goes_around_a_rover_that_stands_in_its_way() -> None:
    walker = social()
    free = walked(walker, 4.0, [])
    rover = (*free[200].tolist(), 0.3)  # where it would be after 2 s
    walker.restart()
    gaps = np.linalg.norm(walked(walker, 4.0, [rover]) - rover[:2], axis=1) - 0.3 - 0.25
    assert gaps.min() > 0.0
    assert (np.linalg.norm(free - rover[:2], axis=1) - 0.55).min() < -0.5


def test_a_social_walker_looks_where_it_walks() -> None:
    walker = social()
    places = [walker.walk(n * TICK_S, TICK_S, []) for n in range(1, 1200)]
    for before, after in pairwise(places[100:]):
        x, y = after.x - before.x, after.y - before.y
        if math.hypot(x, y) > 0.06 * TICK_S:
            assert math.remainder(after.yaw - math.atan2(y, x), math.tau) == pytest.approx(0.0, abs=1e-6)


def test_who_does_not_get_on_heads_for_the_next_point_after_twenty_seconds_more() -> None:
    stroll = Mock()
    stroll.spot.side_effect = [(0.0, 0.0), (5.0, 0.0), (0.0, 5.0)].__getitem__
    walker = SocialWalker(stroll, Room(BARE), speed=0.5, delay=0.0, radius=0.25)
    for time_s, heads_for in ((0.01, 1), (30.0, 1), (30.02, 2)):  # the leg takes 10 s
        walker.walk(time_s, 0.0, [])
        stroll.spot.assert_called_with(heads_for)


def test_walls_in_sight_push_a_social_walker() -> None:
    """Against the forces themselves, which are told of the wall from the beginning."""
    walker, goal = heading_for(6.0, 0.5), np.array([6.0, 0.5])
    place, velocity = np.zeros(2), np.zeros(2)
    for told in walked(walker, 3.0, []):
        wanted = (goal - place) / np.linalg.norm(goal - place)
        place, velocity = step(
            place, velocity, wanted, radius=0.25, bodies=(), walls=[outline(WALL)], seconds=TICK_S
        )
        np.testing.assert_allclose(told, place, atol=1e-9)
    assert 1.6 < place[0] < 2.55  # in front of it


def test_a_social_walker_turns_from_five_centimetres_a_second_on() -> None:
    walker = heading_for(0.0, 5.0)  # 1 m/s in half a second: 0.02, 0.04, 0.06 m/s
    yaws = [walker.walk(n * TICK_S, TICK_S, []).yaw for n in (1, 2, 3)]
    assert yaws == pytest.approx([0.0, 0.0, math.pi / 2])


def test_who_strolls_after_a_delay_stands_at_the_begin_until_then() -> None:
    stroll = Mock()
    stroll.spot.side_effect = lambda number: (float(number), 2.0)
    late = StrollRoute(stroll, 0.5, 10.0)
    assert [late.place(time_s).x for time_s in (0.0, 9.0, 11.0)] == pytest.approx([0.0, 0.0, 0.5])


def test_a_stroll_stays_within_its_circle_wherever_that_is() -> None:
    stroll = Stroll("a", Room(BARE), (4.0, -3.0), within=3.0, radius=0.25, rng=np.random.default_rng(0))
    spots = np.array([stroll.spot(n) for n in range(100)])
    away = np.hypot(*(spots - (4.0, -3.0)).T)
    assert away.max() <= 3.0 + 1e-3
    assert np.mean(away < 1.5) == pytest.approx(0.25, abs=0.12)  # as many a square metre everywhere
    assert away[0] > 2.0
    millimetres = 1000 * spots  # so that every processor has the same ones
    np.testing.assert_allclose(millimetres, np.round(millimetres), atol=1e-6)
    assert not np.allclose(millimetres % 10, 0.0)


def test_a_social_walker_waits_for_its_delay() -> None:
    walker = social("s=social:delay=1")
    places = walked(walker, 1.5, [])
    assert (places[:100] == places[0]).all()
    assert not (places[100:] == places[0]).all()


def test_a_social_walker_looks_for_walls_again_every_half_metre(monkeypatch: pytest.MonkeyPatch) -> None:
    walker, looked = social(), Mock(return_value=[])
    monkeypatch.setattr(Room, "walls_near", looked)
    way = np.diff(walked(walker, 6.0, []), axis=0)
    assert 0.0 < looked.call_count <= 1 + np.linalg.norm(way, axis=1).sum() / 0.5


def test_the_delay_that_is_told_comes_after_that_of_the_file(tmp_path: Path) -> None:
    points = "".join(
        f"<waypoint><time>{at}</time><pose>{at} 2 0 0 0 0</pose></waypoint>" for at in (0, 4)
    )
    script = f"<script><delay_start>2</delay_start><trajectory>{points}</trajectory></script>"
    (file := tmp_path / "a.sdf").write_text(f"<actor name='a'>{script}</actor>")
    way = with_actors(BARE, parse_actors([f"{file}:delay=1"])).people[0].way()
    assert isinstance(way, Route)
    assert [way.place(time_s).x for time_s in (2.9, 5.0)] == pytest.approx([0.0, 2.0])


def test_the_worlds_hash_tells_who_walks_and_where() -> None:
    words: tuple[list[str], ...] = (
        [],
        ["g=0,2/0,3"],
        ["g=0,2/0,4"],
        ["h=0,2/0,3"],
        ["g=0,2/0,3:speed=2"],
        ["g=random"],
    )
    hashes = {terrain_hash(with_actors(BARE, parse_actors(some))) for some in words}
    assert len(hashes) == len(words)
    assert terrain_hash(BARE) in hashes
