"""A run becomes parts: what is looked up, who starts where, and which mistakes only that shows."""

import math
import os
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.episode.assembly import (
    actor_names,
    check,
    check_world,
    fleet,
    gravity,
    scenery,
    world_of,
)
from harness.episode.episode import episodes_of
from harness.episode.metrics_feed import metric_settings
from harness.episode.together import Together
from harness.physics.berths import GAP
from harness.robots import ROVERS, find_rover
from harness.samples import ActorPoses, Place, TruthState
from harness.spec import Run
from harness.spec.fleet import parse_rovers
from harness.world.actors.random_walk import KEPT_CLEAR
from harness.world.obstacles import ObstacleKind
from tests.harness.robots.test_model import brought_along
from tests.support.rovers import LEO

FLAT = Run.of(terrain="flat")
BOX = "<collision name='c'><geometry><box><size>20 20 1</size></box></geometry></collision>"
ROCK = BOX.replace("20 20", "1 1")


def several(*texts: str, **shared: Any) -> Run:  # noqa: ANN401 - fields of a run
    """A run of rovers on flat ground, as --rover gives them."""
    run = FLAT.alone(**shared)
    return fleet(run, parse_rovers(texts, run.rover))


@pytest.mark.parametrize(
    ("wrong", "mend"),
    [
        ({"terrain": "moon"}, "available: flat, slope, rolling, gravel"),
        ({"robot": "r2d2"}, "available: husky, jackal, leo, rover_zero4wd"),
        ({"driver": "drunk"}, "available: wander"),
        ({"noise": ""}, "available: white, hardware, gazebo"),
        ({"sensors": ["sonar"]}, "available: "),
        ({"sensors": ["none", "gnss"]}, "leave out the others, or none"),
        ({"faults": ["imu:gone"]}, "available: "),
        ({"faults": ["gnss:nan"]}, "--sensors gnss adds it"),
        ({"faults": ["scan:beams=x"]}, "give "),
        ({"faults": ["clock:reset=1@2"]}, "takes no value"),
        ({"faults": ["clock:reset"]}, "clock:reset@START"),
        ({"datum": (90.0, 0.0, 0.0)}, "give -89.9 to 89.9"),
        ({"commands": [(1.0, 0.3, 0.0)]}, "this needs driver 'cmd_vel'"),
        ({"goals": [(0.0, 1.0, 2.0, 0.0)]}, "this needs driver 'goal'"),
        ({"cmd_vel_timeout": 1.0}, "other drivers go on"),
        ({"goal_area": (0, 1, 0, 1)}, "goal, beeline, gap, dwa, mppi, policy:FILE"),
        ({"driver": "goal", "goal_area": (0, 1, 0, 1), "goals": [(0, 1, 2, 0)]}, "leave out the goals"),
        ({"terrain": "a.npy", "difficulty": 0.6}, "leave out --difficulty"),
        ({"terrain": "a.npy", "mesh_unit": "cm"}, "applies to SDF worlds and meshes only"),
        ({"terrain": "a.obj", "terrain_size": 20}, "applies to heightmaps only"),
        ({"terrain": "a.obj", "mesh_unit": "mile"}, "available: m, cm, mm, ft, in"),
        ({"actors": ["a=1,2", "a=random"]}, "give one another name"),
    ],
    ids=str,
)
def test_what_does_not_exist_or_fit_is_one_line_with_the_mend(wrong: dict[str, Any], mend: str) -> None:
    with pytest.raises(UsageError) as refused:
        check(Run.of(**wrong))
    assert mend in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_start_of_ones_own_makes_steep_ground_a_world(tmp_path: Path) -> None:
    np.save(tmp_path / "steep.npy", np.add.outer(np.linspace(0.0, 20.0, 41), np.zeros(41)))
    steep = Run.of(terrain=str(tmp_path / "steep.npy"), terrain_size=20)
    with pytest.raises(UsageError, match="no rover can stand within"):
        world_of(steep)
    assert world_of(steep.alone(start=(1.0, 2.0, 3.0))).start == (1.0, 2.0, 3.0)


def test_a_file_that_was_written_anew_is_another_world(tmp_path: Path) -> None:
    path, ramp = tmp_path / "ramp.npy", np.add.outer(np.linspace(0.0, 1.0, 41), np.zeros(41))
    run = Run.of(terrain=str(path), terrain_size=(20.0, 30.0), seed=3)
    for second, relief in enumerate((1.0, 2.0), start=1):
        np.save(path, relief * ramp)
        os.utime(path, (second, second))
        world = world_of(run)
        assert np.ptp(world.ground.heights) == pytest.approx(relief)
        assert (world.ground.half_size, world.seed) == ((10.0, 15.0), 3)
    assert world_of(run) is world_of(run)


def test_rovers_of_one_world_have_one_gravity(tmp_path: Path) -> None:
    option = '<option gravity="0 0 -1.62"/><worldbody>'
    moon = brought_along(tmp_path / "car", **{"<worldbody>": option})
    assert gravity(several(f"{moon}:a", f"{moon}:b")) == 1.62
    with pytest.raises(UsageError, match=r"not leo 9\.8, .*car 1\.62 m/s2; mend"):
        several("leo:a", f"{moon}:b")


def test_gravity_and_people_are_those_of_the_world(tmp_path: Path) -> None:
    way = "".join(
        f"<waypoint><time>{n}</time><pose>{n} 0 0 0 0 0</pose></waypoint>" for n in range(1, 3)
    )
    moon = tmp_path / "moon.sdf"
    moon.write_text(
        "<sdf version='1.9'><world name='moon'><gravity>0 0 -1.62</gravity>"
        f"<model name='m'><static>1</static><link name='l'>{BOX}</link></model>"
        f"<model name='r'><static>1</static><pose>6 6 1 0 0 0</pose><link name='l'>{ROCK}</link></model>"
        f"<actor name='ann'><script><trajectory id='0' type='walk'>{way}</trajectory></script></actor>"
        "</world></sdf>"
    )
    run = Run.of(terrain=str(moon), actors=["bob=5,6"])
    assert actor_names(run.world) == ("ann_actor", "bob_actor"), "first those of the world"
    assert (gravity(run), gravity(Run.of(terrain="flat"))) == (1.62, 9.8)
    check_world(run)
    assert metric_settings(run, {}, extended=True).extended.gravity == 1.62
    check_world(run.alone(driver="goal", goals=((0.0, 9.7, -9.7, 0.0),)))  # almost at the edge
    for robot in ROVERS:
        (told,) = [note for note in world_of(run.alone(robot=robot)).notes if "no higher than" in note]
        assert f"no higher than {ROVERS[robot].clearance:g} m above" in told
    moon.write_text(moon.read_text().replace("<pose>2 0", "<pose>99 0"))
    os.utime(moon, (1, 1))
    with pytest.raises(UsageError, match="ann"):
        check_world(Run.of(terrain=str(moon)))


def test_goals_and_the_timeout_of_commands_are_for_those_who_heed_them() -> None:
    texts = ("leo:a,driver=goal", "leo:b,driver=cmd_vel,x=2,y=0", "leo:c,x=4,y=0")
    rovers = several(*texts, goal_area=(-3, 3, -3, 3), cmd_vel_timeout=0.5).rovers
    assert [rover.goal_area is not None for rover in rovers] == [True, False, False]
    assert [rover.cmd_vel_timeout for rover in rovers] == [None, 0.5, None]
    heeded = {"commands": ((1.0, 0.3, 0.0),), "goals": ((0.0, 1.0, 2.0, 0.0),)}
    for field, by in (("commands", "cmd_vel"), ("goals", "goal")):
        run = several("leo:a", f"leo:b,x=2,y=0,driver={by}")
        check(run.but(plan=run.plan.but(**{field: heeded[field]})))  # one of them is enough
    run = several("leo:a", "leo:b,x=2,y=0,driver=goal", route="19.7,-19.7", duration=0.05)
    assert [len(batch.goals) for batch in next(Together(episodes_of(run)).batches())] == [0, 1]


def test_rovers_without_a_start_stand_beside_the_first_and_nobody_touches() -> None:
    texts = ("leo", "husky", f"leo:near,x=0,y={LEO.reach * 2 + GAP:.3f}", *["leo"] * 5)
    run = several(*texts)
    world, members = scenery(run)
    assert members[0].start == world.start
    assert [one.name for one in members] == [one.name for one in run.rovers]
    for number, one in enumerate(members):
        for other in members[:number]:
            apart = math.dist(one.start[:2], other.start[:2])
            assert apart >= one.rover.reach + other.rover.reach + GAP - 1e-3
    assert run == several(*texts)


@pytest.mark.parametrize(
    ("texts", "mend"),
    [
        (("leo:a", "leo:a"), "give each a name of its own"),
        (("nope:a",), "available: husky"),
        (("leo", "leo,x=99,y=0"), "give x between"),
        (("leo", "leo,x=0.1,y=0"), "choose another x and y"),
        (("leo", "leo,x=2,y=2,driver=ram"), "it drives into hazards"),
        (("leo", "leo,driver=fly"), "available: wander"),
        (("leo",) * 17, "at most 16"),
    ],
)
def test_a_fleet_that_cannot_be_is_one_line(texts: tuple[str, ...], mend: str) -> None:
    with pytest.raises(UsageError) as refused:
        episodes_of(several(*texts))
    assert mend in str(refused.value)
    assert "\n" not in str(refused.value)


def test_who_walks_through_a_wall_does_so_for_every_rover_of_a_fleet_and_stops_nobody() -> None:
    """The walk is told with the world; where it goes does not depend on what stands there."""
    shared = {"duration": 0.5, "lidar_beams": 2, "driver": "straight", "terrain": "posts"}
    free = several("leo:a,x=-2,y=3", "rover_zero4wd:b,x=3,y=0", **shared)
    post = next(o for o in world_of(free).obstacles if o.kind is ObstacleKind.HAZARD)
    x, y, _ = post.position
    run = several(
        "leo:a,x=-2,y=3", "rover_zero4wd:b,x=3,y=0", actors=[f"g={x - 0.2},{y}/{x + 0.8},{y}"], **shared
    )
    (note,) = world_of(run).notes
    assert note.startswith("actor 'g' walks through hazard_")
    seen: list[list[tuple[float, ...]]] = [[], []]
    for pair in Together(episodes_of(run)).batches():
        for places, batch in zip(seen, pair, strict=True):
            told = (s for tick in batch.ticks for s in tick.samples if isinstance(s, ActorPoses))
            places += [(s.stamp_ns / 1e9, *s.position[0][:2]) for s in told]
    assert seen[0] == seen[1]
    assert all(at == pytest.approx((x - 0.2 + t, y), abs=0.02) for t, *at in seen[0])


def test_who_stands_in_the_way_of_one_rover_of_a_fleet_is_touched_by_that_one() -> None:
    shared = {"duration": 1.5, "lidar_beams": 2, "driver": "straight", "actors": ["g=3.6,0"]}
    for texts in (("leo:a,x=-2,y=3", "jackal:b,x=3,y=0"), ("jackal:b,x=3,y=0", "leo:a,x=-2,y=3")):
        *_, last = Together(episodes_of(several(*texts, **shared))).batches()
        touched = [batch.truth.hazard_contacts > 0 for batch in last]
        assert touched == [text.startswith("jackal") for text in texts]


def test_a_rover_whose_place_is_taken_is_put_beside_who_stands_there() -> None:
    """The other stands on; people walk on; both touch nothing."""
    shared = {"duration": 0.3, "lidar_beams": 2, "driver": "straight", "actors": ["g=9,0/9,4"]}
    run = several("leo:a,x=-2,y=3", "rover_zero4wd:b,x=3,y=0,driver=spin", **shared)
    one, other = episodes_of(run)
    batches = Together((one, other)).batches()
    next(batches)
    there = one.simulation.position
    other.reset(Place(*there[:2], 1.0))
    apart = LEO.reach + find_rover("rover_zero4wd").reach + GAP  # to the left of the heading
    left = there[0] - apart * math.sin(1.0), there[1] + apart * math.cos(1.0), 1.0
    assert (*other.simulation.position[:2], other.simulation.yaw) == pytest.approx(left, abs=0.02)
    assert one.simulation.position == there
    other.reset()
    assert other.simulation.position[:2] == pytest.approx((3.0, 0.0), abs=0.02)
    for pair in batches:
        for batch in pair:
            samples = [sample for tick in batch.ticks for sample in tick.samples]
            assert not any(s.hazard_contact for s in samples if isinstance(s, TruthState))
            people = [s for s in samples if isinstance(s, ActorPoses)]
            assert all(s.position[0][1] == pytest.approx(s.stamp_ns / 1e9, abs=0.02) for s in people)


def test_a_free_place_of_a_target_lies_near_the_start_that_is_given() -> None:
    (target,) = world_of(FLAT.alone(start=(9.0, -9.0, 0.0), targets=["post:within=4"])).targets
    assert math.dist(target.position[:2], (9.0, -9.0)) <= 4.0


def test_people_walk_about_where_the_rover_starts() -> None:
    run = Run.of(terrain="flat", start=(9.0, -9.0, 0.0), actors=[f"p{n}=random" for n in range(30)])
    for one in world_of(run).people:
        assert one.centre == (9.0, -9.0)
        assert math.dist(one.begin, one.centre) > KEPT_CLEAR


def test_each_rover_of_a_fleet_counts_the_energy_of_its_own_battery(tmp_path: Path) -> None:
    spare = shutil.copytree(ROVERS["husky"].folder, tmp_path / "spare")  # not on /battery/battery_state
    with (spare / "rover.yaml").open("a") as file:
        file.write("sensors: [{kind: battery, name: spare}]\n")
    texts = "husky:a,actuators=real,sensors=battery", "husky:b", f"{spare}:c,actuators=real"
    run = fleet(Run(), parse_rovers(texts, Run().rover))
    settings = [metric_settings(run, {}, number, extended=True) for number in range(3)]
    assert [each.extended.energy for each in settings] == [True, False, False]
