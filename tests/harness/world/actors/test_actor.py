"""People in a world: routes that are refused, and random walks that keep their promises."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import kstest

from harness.base.errors import UsageError
from harness.samples import Place
from harness.spec.actor import ActorOptions
from harness.world.actors.free_space import FreeSpace
from harness.world.actors.random_walk import RandomWalk, RandomWalker
from harness.world.actors.social_force import SocialForceWalker
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World, terrain_hash, with_actors
from tests.support.words import parse_actors

WALL = Obstacle(ObstacleKind.HAZARD, "box", (0.2, 1.0, 0.5), (3.0, 0.0, 0.5))
BARE = World("bare", Heightfield(np.zeros((201, 201)), 0.1), (WALL,), seed=3, difficulty=0.0)
OBLONG = replace(BARE, ground=Heightfield(np.zeros((81, 61)), 0.1, (10.0, -20.0)), obstacles=())
OPTIONS = ActorOptions(within=3.0)


def places(text: str, *times: float, world: World = BARE) -> list[Place]:
    walk = with_actors(world, parse_actors([text])).people[0].walk()
    assert not isinstance(walk, SocialForceWalker)
    return [walk.place(time_s) for time_s in times]


@pytest.mark.parametrize(
    ("world", "text", "said"),
    [
        (
            OBLONG,
            "g=10,-20/10,-16",
            r"off the map at 10\.00,-16\.40; .* x from 7\.5 to 12\.5 m and y from -23\.5 to -16\.5 m$",
        ),
        (BARE, "g=random:within=2", "actor 'g': no free place within 2 m of the rover's start at 0,0"),
    ],
)
def test_routes_without_space_are_refused_with_the_place(world: World, text: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        with_actors(world, parse_actors([text]))
    assert with_actors(BARE, parse_actors(["g=0,1.5/6,1.5"])).people[0].begin == (0.0, 1.5)


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("g=0,0/6,0", "2.60,0.00"),
        ("g=0,2/6,2/6,-2:route=closed", "3.37,-0.25"),
        ("g=0,1.5/6,1.5:radius=0.6", "2.50,1.50"),
        ("g=3,0", "3.00,0.00"),
        ("g=0,1.5/6,1.5", ""),
    ],
)
def test_a_route_through_a_hazard_is_walked_and_told_with_the_place(text: str, where: str) -> None:
    world = with_actors(BARE, parse_actors([text, "h=0,3/1,3"]))
    told = [f"actor 'g' walks through hazard_0 at {where}, as Gazebo's do"] if where else []
    assert list(world.notes) == told
    assert (places("g=0,0/6,0", 3.0)[0].x, places("g=0,0/6,0", 3.0)[0].y) == (3.0, 0.0)  # at 1 m/s


def test_a_random_walk_is_straight_free_and_steady_and_depends_on_nobody_else() -> None:
    words = ["a=random:speed=2,within=7,radius=0.9,height=2", "b=random:within=7,delay=20"]
    actors = (
        *with_actors(BARE, parse_actors(words)).people,
        *with_actors(BARE, parse_actors(words[1:])).people,
    )
    times = np.arange(0.0, 300.0, 0.5)
    walks = [walk for actor in actors if isinstance(walk := actor.walk(), RandomWalker)]
    ways = np.array([[(p.x, p.y) for t in times for p in [walk.place(t)]] for walk in walks])
    np.testing.assert_array_equal(ways[1], ways[2])
    assert places(words[0], 299.5)[0].x == ways[0, -1, 0]  # whatever was asked before
    steps = np.linalg.norm(np.diff(ways, axis=1), axis=2)
    assert np.flatnonzero(steps[1])[0] == 40  # from 20 s on
    assert (steps <= [[1.0 + 1e-9], [0.5 + 1e-9], [0.5 + 1e-9]]).all()
    assert np.median(steps, axis=1) == pytest.approx([1.0, 0.5, 0.5])
    assert np.linalg.norm(ways, axis=2).max() <= 7.0
    for way, radius in zip(ways, (0.9, 0.25, 0.25), strict=True):
        assert FreeSpace(BARE.ground, BARE.obstacles).blocked(way, radius - 1e-6) is None


class Space(FreeSpace):
    """Free everywhere, but for ways if a test says so."""

    def __init__(self, *, has_ways: bool = True) -> None:
        self.has_ways = has_ways

    def blocked(self, points: np.ndarray, _: float) -> tuple[str, np.ndarray] | None:
        return None if self.has_ways or len(points) == 1 else ("in the way", points[0])


def test_who_has_nowhere_to_go_stays_or_goes_back() -> None:
    space = Space(has_ways=False)
    walk = RandomWalk("a", space, (0.0, 0.0), OPTIONS, np.random.default_rng(0))
    begin = walk.point(0)
    assert [walk.point(index) for index in (1, 2)] == [begin, begin]
    space.has_ways = True
    assert (away := walk.point(3)) != begin
    space.has_ways = False
    assert [walk.point(index) for index in (4, 5, 6)] == [begin, away, begin]
    stuck = RandomWalk("a", space, (0.0, 0.0), OPTIONS, np.random.default_rng(0))
    assert RandomWalker(stuck, 1.0, 0.0).place(9.0).x == begin[0]


def test_way_points_are_spread_evenly_over_their_disc() -> None:
    space = FreeSpace(BARE.ground, ())
    walk = RandomWalk("a", space, (0.0, 0.0), ActorOptions(within=8.0), np.random.default_rng(5))
    x, y = np.array([walk.point(index) for index in range(400)]).T
    for even in ((x**2 + y**2) / 8.0**2, np.arctan2(y, x) / (2.0 * np.pi) + 0.5):
        assert kstest(even, "uniform").pvalue > 1e-3


@pytest.mark.parametrize("loops", [True, False])
def test_a_script_waits_for_the_delay_of_the_file_and_for_the_one_that_is_given(
    tmp_path: Path, loops: bool
) -> None:
    point = "<waypoint><time>{0}</time><pose>{0} {1} 0 0 0 0</pose></waypoint>".format
    script = f"<script><loop>{loops}</loop><delay_start>2</delay_start>{{}}{{}}</script>".lower().format
    file = tmp_path / "a.sdf"
    file.write_text(f"<actor name='a'>{script(point(0, 2), point(4, 2))}</actor>")
    found = places(f"{file}:delay=1,speed=2", 2.9, 5.0, 8.0)
    assert [place.x for place in found] == pytest.approx([0.0, 2.0, 1.0 if loops else 4.0])
    file.write_text(f"<actor name='a'>{script(point(5, 2), point(4, 2))}</actor>")
    with pytest.raises(UsageError, match=r"^actor 'a': the times of its way points"):
        with_actors(BARE, parse_actors([str(file)]))


def test_way_points_are_walked_at_the_speed_and_after_the_delay_that_are_given(tmp_path: Path) -> None:
    points = "".join(f"<waypoint><pose>{x} 2 {z} 0 0 0</pose></waypoint>" for x, z in ((0, 0), (3, 4)))
    (file := tmp_path / "a.sdf").write_text(f"<trajectory>{points}</trajectory>")
    assert places(f"{file}:speed=2", 1.25)[0].x == pytest.approx(1.5)  # of 5 m
    waits = places("g=0,2/4,2:delay=3,speed=2", 2.9, 4.0)
    assert [place.x for place in waits] == pytest.approx([0.0, 2.0])
    (closed,) = places("g=0,2/4,2/4,5:route=closed", 7.0 + math.hypot(4.0, 3.0) - 1.0)
    assert (closed.x, closed.y) == pytest.approx((0.8, 2.6))


def test_the_worlds_hash_depends_on_who_walks_and_where() -> None:
    words: tuple[list[str], ...] = (
        *([], ["g=0,2/0,3"], ["g=0,2/0,4"], ["h=0,2/0,3"], ["g=0,2/0,3:speed=2"], ["g=random"]),
        ["g=social"],
    )
    hashes = {terrain_hash(with_actors(BARE, parse_actors(some))) for some in words}
    assert len(hashes) == len(words)
    assert terrain_hash(BARE) in hashes
    kept = with_actors(BARE, parse_actors(["g=0,2/0,3:push=1", "s=social"]))  # as it always was
    assert terrain_hash(kept) == "bcc9fc19cf7b34a9c5e7257cfbcdebc1432ebd5795a0e39567079519d6cfe2e8"
    others = with_actors(with_actors(BARE, parse_actors(["g=0,2/0,3"])), parse_actors(["h=random"]))
    assert [actor.name for actor in others.people] == ["h_actor"]
