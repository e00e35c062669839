"""People in a world: ways that are refused, and walkers that keep their promises."""

import math
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from harness.world.actors.room import Room
from harness.world.actors.stroll import Stroll, StrollRoute
from harness.world.actors.walker import SocialWalker

from harness.base.errors import UsageError
from harness.world.actors.actor import with_actors
from harness.world.actors.route import Route
from harness.world.actors.social_force import step
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, outline
from harness.world.world import World, terrain_hash
from tests.support.words import parse_actors

WALL = Obstacle(ObstacleKind.HAZARD, "box", (0.2, 1.0, 0.5), (3.0, 0.0, 0.5))
BARE = World("bare", Heightfield(np.zeros((201, 201)), 0.1), (WALL,), seed=3, difficulty=0.0)
OBLONG = replace(BARE, ground=Heightfield(np.zeros((81, 61)), 0.1, (10.0, -20.0)), obstacles=())
TICK_S = 0.01


@pytest.mark.parametrize(
    ("world", "text", "told"),
    [
        (BARE, "g=0,0/6,0", r"actor 'g' walks through hazard_0 at 2\.60,0\.00; lead it around"),
        (
            OBLONG,
            "g=10,-20/10,-16",
            r"off the map at 10\.00,-16\.40; .* x from 7\.5 to 12\.5 m and y from -23\.5 to -16\.5 m$",
        ),
        (BARE, "g=0,2/6,2/6,-2:route=closed", "walks through hazard_0"),
        (BARE, "g=0,1.5/6,1.5:radius=0.6", "walks through hazard_0"),
        (BARE, "g=random:within=2", "actor 'g': no free place within 2 m of the rover's start at 0,0"),
    ],
)
def test_ways_without_room_are_refused_with_the_place(world: World, text: str, told: str) -> None:
    with pytest.raises(UsageError, match=told):
        with_actors(world, parse_actors([text]))
    assert with_actors(BARE, parse_actors(["g=0,1.5/6,1.5"])).people[0].begin == (0.0, 1.5)


def test_a_random_walk_is_straight_free_steady_and_the_names_own() -> None:
    words = ["a=random:speed=2,within=7,radius=0.9,height=2", "b=random:within=7,delay=20"]
    both = with_actors(BARE, parse_actors(words)).people
    alone = with_actors(BARE, parse_actors(words[1:])).people
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
    assert np.flatnonzero(steps[1])[0] == 40  # from 20 s on
    assert (steps <= [[1.0 + 1e-9], [0.5 + 1e-9], [0.5 + 1e-9]]).all()
    assert np.median(steps, axis=1) == pytest.approx([1.0, 0.5, 0.5])
    assert np.linalg.norm(places, axis=2).max() <= 7.0
    for way, radius in zip(places, (0.9, 0.25, 0.25), strict=True):
        assert Room(BARE).trouble(way, radius - 1e-6) is None


def social(text: str = "s=social:within=6") -> SocialWalker:
    way = with_actors(BARE, parse_actors([text])).people[0].way()
    assert isinstance(way, SocialWalker)
    return way


def heading_for(
    *spots: tuple[float, float],
    begin: tuple[float, float] = (0.0, 0.0),
    speed: float = 1.0,
    world: World = BARE,
) -> SocialWalker:
    """One that walks there."""
    stroll = Mock()
    stroll.spot.side_effect = [begin, *spots].__getitem__
    return SocialWalker(stroll, Room(world), speed=speed, delay=0.0, radius=0.25)


def walked(walker: SocialWalker, seconds: float, bodies: list[tuple[float, float, float]]) -> np.ndarray:
    ticks = range(1, round(seconds / TICK_S) + 1)
    return np.array([(p.x, p.y) for n in ticks for p in [walker.walk(n * TICK_S, TICK_S, bodies)]])


def test_after_a_restart_a_walk_is_the_same_whatever_was_seen_before() -> None:
    walker = heading_for((6.0, 0.5), begin=(1.0, 0.0))  # the wall ahead is in sight
    begin = walker.walk(0.0, 0.0, [])
    for seconds in (1.0, 0.05):
        walked(walker, seconds, [])
        walker.restart()
        assert walker.walk(0.0, 0.0, []) == begin
    new = heading_for((6.0, 0.5), begin=(1.0, 0.0))
    np.testing.assert_array_equal(walked(walker, 1.0, []), walked(new, 1.0, []))


@pytest.mark.parametrize(
    ("begin", "limit", "ahead"),
    [
        (2.4, 2.8 - 0.25, (1.0, 0.0)),  # the wall begins at 2.8 m
        *((9.4, 9.5, ahead) for ahead in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))),
    ],
)
def test_who_is_pushed_against_a_wall_or_to_an_edge_stands_there_and_goes_on_from_rest(
    begin: float, limit: float, ahead: tuple[float, float]
) -> None:
    x, y = ahead
    walker = heading_for((-5.0 * x, -5.0 * y), begin=(begin * x, begin * y))
    crowd = [((begin - 0.4) * x, (begin - 0.4) * y, 0.3)] * 9
    way = walked(walker, 0.3, crowd) @ ahead
    assert limit - 0.02 < way[-1] == way.max() <= limit
    back = walker.walk(0.31, TICK_S, [])
    acceleration = -1.0 / 0.5 - (50.0 * math.exp(-(limit - way[-1]) / 0.2) if limit < 9.0 else 0.0)
    speed = max(acceleration * TICK_S, -1.3)
    assert back.x * x + back.y * y - way[-1] == pytest.approx(speed * TICK_S, rel=1e-6)


@pytest.mark.parametrize(("distance", "heads_for"), [(0.501, 1), (0.499, 2)])
def test_a_way_point_is_reached_from_half_a_metre(distance: float, heads_for: int) -> None:
    walker = heading_for((distance, 0.0), (9.0, 0.0))
    for time_s in (0.01, 0.02):
        walker.walk(time_s, 0.0, [])
    spot: Mock = walker._stroll.spot  # type: ignore[assignment]
    spot.assert_called_with(heads_for)


def test_a_social_walker_goes_around_a_rover_that_stands_in_its_way() -> None:
    walker = social()
    free = walked(walker, 4.0, [])
    rover = (*free[200].tolist(), 0.3)  # where it would be after 2 s
    walker.restart()
    gaps = np.linalg.norm(walked(walker, 4.0, [rover]) - rover[:2], axis=1) - 0.3 - 0.25
    assert gaps.min() > 0.0
    assert (np.linalg.norm(free - rover[:2], axis=1) - 0.55).min() < -0.5


def test_who_does_not_get_on_heads_for_the_next_point_after_twenty_seconds_more() -> None:
    walker = heading_for((5.0, 0.0), (0.0, 5.0), (9.0, 9.0), speed=0.5)
    spot: Mock = walker._stroll.spot  # type: ignore[assignment]
    # Either leg takes 10 s.
    for time_s, heads_for in ((0.01, 1), (30.0, 1), (30.02, 2), (60.0, 2), (60.04, 3)):
        walker.walk(time_s, 0.0, [])
        spot.assert_called_with(heads_for)


def test_walls_in_sight_push_a_social_walker() -> None:
    """Against the forces themselves, which are told of the wall from the beginning."""
    other = replace(WALL, position=(1.0, -1.6, 0.5))
    world = replace(BARE, obstacles=(WALL, other))
    walker, goal = heading_for((6.0, 0.5), world=world), np.array([6.0, 0.5])
    place, velocity = np.zeros(2), np.zeros(2)
    walls = [outline(WALL), outline(other)]
    for tick in range(1, 61):
        told, wanted = walker.walk(0.05 * tick, 0.05, []), (goal - place) / np.linalg.norm(goal - place)
        place, velocity = step(
            place, velocity, wanted, radius=0.25, bodies=(), walls=walls, seconds=0.05
        )
        assert (told.x, told.y) == pytest.approx(place, abs=1e-9)
    assert 1.6 < place[0] < 2.55  # in front of it


def test_a_social_walker_looks_where_it_walks_from_five_centimetres_a_second_on() -> None:
    walker, aside = heading_for((-3.0, -4.0)), (-1.0, 0.8, 0.3)
    one, two, three = (walker.walk(n * TICK_S, TICK_S, [aside]) for n in (1, 2, 3))
    x, y = three.x - two.x, three.y - two.y  # 2.1 m/s^2: 0.02, 0.04, 0.06 m/s
    assert [one.yaw, two.yaw, three.yaw] == pytest.approx([0.0, 0.0, math.atan2(y, x)])
    assert math.atan2(y, x) > math.atan2(-4.0, -3.0) + 0.1  # pushed off its way


def test_who_strolls_after_a_delay_stands_at_the_begin_until_then() -> None:
    stroll = Mock()
    stroll.spot.side_effect = lambda number: (float(number), 2.0)
    late = StrollRoute(stroll, 0.5, 10.0)
    assert [late.place(time_s).x for time_s in (0.0, 9.0, 11.0)] == pytest.approx([0.0, 0.0, 0.5])
    fast = StrollRoute(stroll, 4.0, 1.0)  # its legs are a metre long
    assert [fast.place(time_s).x for time_s in (1.5, 2.6, 93.0)] == pytest.approx([2.0, 6.4, 368.0])


class Space(Room):
    """Room for people wherever they want to be."""

    has_ways = True

    def __init__(self) -> None:
        super().__init__(BARE)
        self.radii: set[float] = set()

    def trouble(self, _: object, radius: float) -> None:
        """Nothing is in the way."""
        self.radii.add(radius)

    def is_clear(self, _: object, __: object, radius: float) -> bool:
        """Tells what has been said of all ways."""
        self.radii.add(radius)
        return self.has_ways


def test_who_has_nowhere_to_go_goes_back_or_stays() -> None:
    room = Space()
    room.has_ways = False
    stroll = Stroll("a", room, (0.0, 0.0), within=3.0, radius=0.25, rng=np.random.default_rng(0))
    begin = stroll.spot(0)
    assert StrollRoute(stroll, 1.0, 0.0).place(9.0).x == begin[0]
    stays = len(stroll._spots)
    room.has_ways = True
    assert (away := stroll.spot(stays)) != begin
    room.has_ways = False
    assert [stroll.spot(stays + n) for n in (1, 2, 3)] == [begin, away, begin]
    assert room.radii == {0.25}


def polar(rng: np.random.Generator, start: tuple[float, float], within: float) -> np.ndarray:
    """200 points of a disc, as many a square metre everywhere, to the millimetre, shape (200, 2)."""
    share, turn = rng.uniform(size=(200, 2)).T
    spots = complex(*start) + within * share**0.5 * np.exp(2j * np.pi * turn)
    return np.round(np.column_stack([spots.real, spots.imag]), 3)


@pytest.mark.parametrize("walker", ["random", "social"])
def test_where_a_stroll_leads_is_of_the_worlds_seed_the_name_and_the_start(walker: str) -> None:
    """The draws are part of what a seed means: numpy's for the key (20, bytes of the name)."""
    world = replace(BARE, start=(4.0, -3.0, 1.0), seed=7, obstacles=())
    for name in ("b", "bob", "eve", "zoe_2"):
        (actor,) = with_actors(world, parse_actors([f"{name}={walker}:within=5"])).people
        rng = np.random.default_rng(np.random.SeedSequence(7, spawn_key=(20, *name.encode())))
        spots = polar(rng, (4.0, -3.0), 5.0)
        inside = (np.abs(spots) <= 9.5).all(axis=1)
        far = np.hypot(*(spots - (4.0, -3.0)).T) > 2.0
        assert actor.begin == pytest.approx(spots[inside & far][0], abs=1e-9)


def test_legs_are_a_metre_long_at_least_and_lead_to_the_first_point_that_is_drawn() -> None:
    for seed in range(40):
        rng = np.random.default_rng(seed)
        stroll = Stroll("a", Space(), (0, 0), within=3.0, radius=0.25, rng=np.random.default_rng(seed))
        here, least = np.zeros(2), 2.0
        for number in range(6):
            spots = polar(rng, (0.0, 0.0), 3.0)
            here = spots[np.hypot(*(spots - here).T) >= least][0]
            np.testing.assert_allclose(stroll.spot(number), here, atol=1e-9)
            least = 1.0


def test_a_social_walker_is_as_fast_and_as_wide_as_it_is_told() -> None:
    """By its first step: 2 m/s within half a second, and Helbing's push of a body a metre away."""
    walker = social("s=social:within=6,speed=2,radius=0.6,push=1")
    begin, alone = (walker.walk(TICK_S * n, TICK_S, []) for n in (0, 1))
    assert math.dist((begin.x, begin.y), (alone.x, alone.y)) == pytest.approx(4.0 * TICK_S**2)
    pushes = []
    for side in (1.0, -1.0):  # what is behind counts less
        walker.restart()
        pushed = walker.walk(TICK_S, TICK_S, [(begin.x + side, begin.y, 0.3)])
        pushes.append(abs(pushed.x - alone.x) / TICK_S**2)
    assert max(pushes) == pytest.approx(7.0 * math.exp(-(1.0 - 0.3 - 0.6) / 0.3))


def test_each_way_of_a_social_walker_waits_for_its_delay_at_its_begin() -> None:
    (actor,) = with_actors(BARE, parse_actors(["s=social:delay=1"])).people
    one, other = (walked(way, 1.5, []) for way in (actor.way(), actor.way()))  # type: ignore[arg-type]
    assert (one[:100] == actor.begin).all()
    assert (one[100:] != actor.begin).any(axis=1).all()
    np.testing.assert_array_equal(one, other)


def test_a_social_walker_looks_for_walls_again_every_half_metre(monkeypatch: pytest.MonkeyPatch) -> None:
    walker, looked = social(), Mock(return_value=[])
    monkeypatch.setattr(Room, "walls_near", looked)
    way = np.diff(walked(walker, 6.0, []), axis=0)
    assert 0.0 < looked.call_count <= 1 + np.linalg.norm(way, axis=1).sum() / 0.5


@pytest.mark.parametrize("loops", [True, False])
def test_the_delay_that_is_told_comes_after_that_of_the_file(tmp_path: Path, loops: bool) -> None:
    points = "".join(
        f"<waypoint><time>{at}</time><pose>{at} 2 0 0 0 0</pose></waypoint>" for at in (0, 4)
    )
    loop = f"<loop>{str(loops).lower()}</loop>"
    script = f"<script>{loop}<delay_start>2</delay_start><trajectory>{points}</trajectory></script>"
    (file := tmp_path / "a.sdf").write_text(f"<actor name='a'>{script}</actor>")
    way = with_actors(BARE, parse_actors([f"{file}:delay=1,speed=2"])).people[0].way()
    assert isinstance(way, Route)
    assert [way.place(t).x for t in (2.9, 5.0, 8.0)] == pytest.approx([0.0, 2.0, 1.0 if loops else 4.0])
    file.write_text(f"<actor name='a'>{script.replace(' 2 0 0 0 0', ' 0 0 0 0 0')}</actor>")
    with pytest.raises(UsageError, match="actor 'a' walks through hazard_0"):
        with_actors(BARE, parse_actors([str(file)]))
    backwards = script.replace("<time>0<", "<time>5<")
    file.write_text(f"<actor name='a'>{backwards}</actor>")
    with pytest.raises(UsageError, match=r"^actor 'a': the times of its way points"):
        with_actors(BARE, parse_actors([str(file)]))
    points = "".join(f"<waypoint><pose>{x} 2 {z} 0 0 0</pose></waypoint>" for x, z in ((0, 0), (3, 4)))
    file.write_text(f"<trajectory>{points}</trajectory>")
    climbs = with_actors(BARE, parse_actors([f"{file}:speed=2"])).people[0].way()
    assert isinstance(climbs, Route)
    assert climbs.place(1.25).x == pytest.approx(1.5)  # of 5 m
    waits = with_actors(BARE, parse_actors(["g=0,2/4,2:delay=3,speed=2"])).people[0].way()
    assert isinstance(waits, Route)
    assert [waits.place(time_s).x for time_s in (2.9, 4.0)] == pytest.approx([0.0, 2.0])


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
    others = with_actors(with_actors(BARE, parse_actors(["g=0,2/0,3"])), parse_actors(["h=random"]))
    assert [actor.name for actor in others.people] == ["h_actor"]
    assert vars(others) | {"people": ()} == vars(BARE)
