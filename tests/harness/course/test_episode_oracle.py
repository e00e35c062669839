"""Whole episodes of every track, recomputed from what was sampled and from the world's shapes."""

import math
from pathlib import Path
from typing import ClassVar

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.base.errors import RunFailed
from harness.course.attempt import drive_with
from harness.course.planner import Planner
from harness.course.task import Case
from harness.course.tracks import find_track
from harness.course.tracks.dynabarn import key_frames
from harness.course.tracks.grounds import BLIND
from harness.drivers.base import DriverContext, Observation
from harness.episode.assembly import world_of
from harness.robots import find_rover
from harness.samples import ActorPoses, JointStates, LaserScan, Pose, Sample, Twist
from harness.spec.world import DEFAULT_DATUM
from harness.world.geodesy import Datum
from harness.world.obstacles import ObstacleKind, outline
from harness.world.route import marks
from harness.world.world import World
from tests.harness.course.conftest import driven, witnessed

EPISODES = [
    ("goal", "barn", 1), ("straight", "barn", 0), ("straight", "dynabarn", 0), ("straight", "rocky", 1),
    ("goal", "rocky", 1), ("straight", "blind", 0), ("gap", "mission", 0),
]  # fmt: skip


def gaps(world: World, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance from each place to the nearest edge of a hazard, from above [m]; 0 within one."""
    nearest = np.full(len(places), np.inf)
    for wall in (outline(one) for one in world.obstacles if one.kind is ObstacleKind.HAZARD):
        along, off = np.roll(wall, -1, axis=0) - wall, places[:, None] - wall
        share = np.clip((off * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-12), 0.0, 1.0)
        edge = np.linalg.norm(off - share[..., None] * along, axis=2).min(axis=1)
        sides = along[:, 0] * off[..., 1] - along[:, 1] * off[..., 0]
        inside = (sides >= 0.0).all(axis=1) | (sides <= 0.0).all(axis=1)
        nearest = np.minimum(nearest, np.where(inside, 0.0, edge))
    return nearest


@pytest.mark.parametrize(("entry", "track", "seed"), EPISODES)
def test_an_episode_is_what_its_samples_say(entry: str, track: str, seed: int) -> None:
    result, witness = witnessed(entry, track, seed)
    task, world, batches = witness.task, witness.world, witness.batches
    rule, rover = task.rule, find_rover(task.run.rover.robot)
    samples = [sample for batch in batches for tick in batch.ticks for sample in tick.samples]
    times = np.array([batch.truth.time_ns for batch in batches]) / 1e9
    way = np.array([batch.truth.position for batch in batches])
    assert np.diff(times, prepend=0.0) == pytest.approx(0.05)

    start = np.hypot(*(way[:, :2] - world.start[:2]).T)
    began = times[np.argmax(start >= rule.begins_at)] if rule.begins_at else 0.0
    assert result.time == pytest.approx(times[-1] - began)
    poses = [sample for sample in samples if isinstance(sample, Pose)]
    length = np.linalg.norm(np.diff([pose.position for pose in poses], axis=0), axis=1).sum()
    assert result.path == pytest.approx(length, rel=0.03, abs=0.1)
    leaning = [
        math.acos(min(1 - 2 * (q[0] ** 2 + q[1] ** 2), 1.0)) for q in (p.orientation for p in poses)
    ]
    assert result.tilt_p95 == pytest.approx(np.percentile(leaning, 95, method="inverted_cdf"), abs=1e-5)
    joints = [sample for sample in samples if isinstance(sample, JointStates)]
    power = [np.abs(np.multiply(one.effort, one.velocity)).sum() for one in joints]
    spans = np.diff([one.stamp_ns for one in joints], prepend=0) / 1e9
    assert result.energy == pytest.approx(power @ spans, rel=1e-6)

    crowd, near = ActorPoses(0, (), ()), list[bool]()
    for batch in batches:
        for tick in batch.ticks:
            crowd = tick.of(ActorPoses) or crowd
        near.append(
            any(
                math.dist(at[:2], batch.truth.position[:2]) - one.spec.options.radius < 0.5
                for at, one in zip(crowd.position, world.people, strict=False)
            )
        )
    still = gaps(world, way[:, :2])  # it looks again where the rover has moved by 0.1 m
    risk = {
        within: 0.05 * int((np.array(near) | (still < within)).sum()) for within in (0.37, 0.5, 0.63)
    }
    assert risk[0.37] - 0.01 <= result.risk_s <= risk[0.63] + 0.01
    assert result.risk_s == pytest.approx(risk[0.5], rel=0.25, abs=0.3)

    left, passed = marks(task.run.plan.route, world.targets, Datum(*DEFAULT_DATUM)), 0  # type: ignore[arg-type]
    for place in way[:, :2].tolist():
        passed += passed < len(left) and math.dist(left[passed].place, place) <= left[passed].radius
    touched = batches[-1].truth.hazard_contact_s
    ended = {
        "contact": rule.touch_ends and touched > 0.0 and still[-1] < rover.reach,
        "reached": passed == len(left) and result.time < rule.limit + 0.05,
        "tipped": max(leaning) > 1.0,
        "time": result.time == pytest.approx(rule.limit, abs=0.06),
    }
    assert ended[result.ending], result
    assert result.of_goals == len(left)
    assert result.hazard_s == pytest.approx(touched)
    assert result.scrape_s == pytest.approx(batches[-1].truth.scrape_s)
    assert result.goals <= passed

    model = mujoco.MjModel.from_xml_path(str(rover.model_path))
    work = result.energy / (model.body_mass.sum() * 9.81 * result.shortest)
    halved = (1 + touched) * (1 + result.scrape_s / 10) * (1 + max(0.0, work - 1) / 5)
    left_over = 1 / halved if rule.penalties else 1.0
    assert result.penalty == pytest.approx(left_over, rel=1e-3)
    quick = result.optimal / np.clip(
        result.time, rule.fastest * result.optimal, rule.slowest * result.optimal
    )
    won = result.ending == "reached"
    assert result.score == pytest.approx(won * quick * result.penalty, abs=2e-6)
    assert result.spl == pytest.approx(won * min(1.0, result.shortest / result.path), abs=2e-6)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("track", ["rocky", "blind", "mission", "dunes", "marsyard"])
def test_goals_of_a_ground_are_as_far_and_as_free_as_its_track_says(
    track: str, seed: int, tmp_path: Path
) -> None:
    """Beside the published ranges: room for the rover, its heading, and the length of the way."""
    ranges = {"mission": (5.0, 8.0)}
    if seed and track in ("dunes", "marsyard"):
        return  # nothing but the ground is in the way
    task = find_track(track).task(Case(track, seed), tmp_path)
    world, rover = world_of(task.run), find_rover(task.run.rover.robot)
    goals = [m.place for m in marks(task.run.plan.route, world.targets, Datum(*DEFAULT_DATUM))]  # type: ignore[arg-type]
    way = [(0.0, 0.0), *goals]
    low, high = ranges.get(track, (9.0, 12.0))
    legs = [math.dist(a, b) for a, b in zip(way, goals, strict=False)]
    assert all(low - 0.01 <= leg <= high + 0.01 for leg in legs)
    assert gaps(world, np.array(goals)).min() > rover.reach + 0.3 - 0.15
    assert world.start[:2] == (0.0, 0.0)
    assert world.start[2] == pytest.approx(math.atan2(goals[0][1], goals[0][0]), abs=2e-3)
    assert sum(legs) - 0.3 < task.shortest < 2.0 * sum(legs)
    assert task.optimal == pytest.approx(task.shortest / rover.top_speed)
    assert task.run.duration == task.rule.limit + 5.0
    fails = BLIND.faults[seed] if track == "blind" else ()
    assert tuple(map(str, task.run.rover.faults)) == fails


def test_a_goal_has_as_much_room_around_it_as_is_asked_for() -> None:
    world = world_of(BLIND.run(**BLIND.world))
    planner = Planner(world, find_rover(BLIND.robot))
    drawn = [BLIND.place(planner, [(0.0, 0.0)], 1.2, np.random.default_rng(seed)) for seed in (3, 7)]
    assert gaps(world, np.array(drawn)).min() > 1.2 - 0.15


@pytest.mark.parametrize("seed", [0, 7, 23])
def test_movers_of_dynabarn_go_along_their_key_frames_over_and_over(seed: int, tmp_path: Path) -> None:
    world = world_of(find_track("dynabarn").task(Case("dynabarn", seed), tmp_path).run)
    worlds = key_frames()
    frames = [np.array(one) for one in worlds[sorted(worlds)[seed % len(worlds)]]]
    walks = [person.walk() for person in world.people]
    assert len(walks) == len(frames)

    def off(entered: np.ndarray, later: float) -> np.ndarray:
        """By how much each mover is elsewhere than its key frames say, for each time of entering."""
        gaps = []
        for one, walk in zip(frames, walks, strict=True):
            at = (entered + later) % one[-1, 2]
            place = walk.place(later)  # type: ignore[union-attr]
            x, y = (np.interp(at, one[:, 2], one[:, column]) for column in (0, 1))
            jumps = np.minimum(at, one[-1, 2] - at) < 0.02  # where it is put back to its begin
            gaps.append(np.where(jumps, 0.0, np.hypot(x - place.x, y - place.y)))
        return np.asarray(np.max(gaps, axis=0))

    tried = np.arange(0.0, 60.0, 2e-3)
    entered = tried[[int(np.argmin(off(tried, 0.0) + off(tried, 1.0)))]]
    assert max(float(off(entered, later)[0]) for later in np.arange(0.0, 90.0, 0.31)) < 0.02


def test_the_one_who_looks_gets_farther_on_a_mission() -> None:
    (blind,), (looking,) = driven("straight", "mission"), driven("gap", "mission")
    assert (looking.of_goals, looking.goals, looking.is_success) == (3, 3, True)
    assert looking.score > blind.score == 0.0
    assert blind.goals < 3


class Looking:
    """Keeps what it is made for, and the first scan with where that was."""

    summary: ClassVar[str] = ""
    senses: ClassVar[frozenset[type[Sample]]] = frozenset((LaserScan,))

    def __init__(self, context: DriverContext) -> None:
        self.context = context

    def command(self, observation: Observation) -> Twist:
        if observation.ranges is None:
            return Twist(0.0, 0.0)
        self.first = observation
        raise RunFailed("it has seen enough")


@pytest.mark.parametrize("track", ["blind", "mission"])  # Leo's lidar looks back, Jackal's ahead
def test_a_scan_along_the_bearings_that_an_entry_is_given_ends_at_what_stands_there(
    track: str, tmp_path: Path
) -> None:
    case = find_track(track).cases(1)[0]
    _, entry = drive_with(case, Looking)
    seen, rover = entry.first, entry.context.rover
    world = world_of(find_track(track).task(case, tmp_path).run)
    assert seen.ranges is not None
    hit = np.isfinite(seen.ranges)
    lidar = complex(rover.lidar_x, rover.lidar_y)
    points = lidar + seen.ranges[hit] * np.exp(1j * entry.context.bearings[hit])
    places = complex(seen.x, seen.y) + points * np.exp(1j * seen.yaw)
    assert np.median(gaps(world, np.array([places.real, places.imag]).T)) < 0.05
