import math
from typing import Any
from unittest.mock import patch

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import RunFailed, UsageError
from harness.base.sim_time import NANOSECONDS
from harness.episode.episode import Episode
from harness.gym.course import Course, Variation, draw_variation
from harness.gym.driven_rover import SENSED, DrivenRover
from harness.gym.options import Randomisation
from harness.physics.scene import SCRAPE_CONTACT
from harness.physics.start import settle
from harness.samples import Imu, LaserScan, Odometry, Pose, Sample, TruthState, Twist
from harness.sensors.depth import DepthOptions
from harness.sensors.ranging import RangeReading
from harness.spec.run import Run
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World
from tests.harness.gym.conftest import MakeConfig

START = 0.75, -0.5, 2.0
FREE = -2.0, -1.0, 2.0
PLAIN = Variation()
READ_AT_ITS_END: tuple[type[Sample], ...] = (LaserScan, Imu, Odometry, RangeReading)  # of a period
COMMANDS = [(0.4, 0.5), (0.4, 0.5), (-0.3, 1.0), (0.0, 0.0), (0.0, 0.0), (0.7, -1.0)] * 2
VARIED = ("geom_friction", "body_mass", "body_inertia", "actuator_forcerange")
POST = Obstacle(ObstacleKind.HAZARD, "box", (0.1, 0.6, 0.5), (0.6, 0.0, 0.5))


@pytest.fixture(scope="module")
def flat_with_post() -> Course:
    ground = Heightfield(np.zeros((41, 41)), 0.2)

    world = World("made", ground, (POST,), seed=0, difficulty=None)
    camera = DepthOptions(name="depth", width=3, height=2, rate=20)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("harness.gym.course.world_of", lambda _: world)
        return Course(Run.of(lidar_beams=8, robot="leo", noise="hardware"), camera)


@pytest.mark.parametrize(("robot", "soil"), [("leo", ""), ("rover_zero4wd", ""), ("leo", "dry_sand")])
def test_a_driven_rover_reads_what_the_same_commands_of_an_episode_publish(
    config: MakeConfig, robot: str, soil: str
) -> None:
    duration = 0.05 * (1 + len(COMMANDS))
    run = config(robot=robot, seed=3, driver="cmd_vel", duration=duration, soil=soil)
    course = Course(run)
    rover = DrivenRover(course, START, PLAIN, run.seed)
    commands = tuple((0.05 * n, *twist) for n, twist in enumerate(COMMANDS, 1))
    episode = Episode(run.alone(start=START, commands=commands))
    published: dict[type, Any] = {}
    for batch, command in zip(episode.batches(), [*COMMANDS, (0.0, 0.0)], strict=True):
        published |= {type(sample): sample for tick in batch.ticks for sample in tick.samples}
        for kind in SENSED:
            assert repr(rover.readings[kind]) == repr(published[kind])
        assert rover.soil == published[TruthState].soil
        scan: Any = rover.readings[LaserScan]
        np.testing.assert_array_equal(scan.ranges, published[LaserScan].ranges)
        rover.advance(Twist(*command))
    simulation = rover.simulation
    simulation.data.qpos[2] += 0.7
    simulation.data.qpos[3:7] = math.cos(0.4), 0.0, math.sin(0.4), 0.0  # it looks down
    simulation.model.hfield_data[:] *= 0.9  # as if all ground had given way
    sunk, ground = (one.scan(simulation.data) for one in (course.lidar_of(simulation), course.lidar))
    assert (sunk != ground).any() == bool(soil)


def test_where_it_stood_last_a_rover_settles_no_second_time_and_drives_as_it_did(
    flat_with_post: Course,
) -> None:
    def driven(start: tuple[float, float, float], variation: Variation) -> list[float]:
        rover = DrivenRover(flat_with_post, start, variation, 0)
        assert rover.simulation.time_ns == NANOSECONDS // 20
        for command in COMMANDS:
            rover.advance(Twist(*command))
        state: list[float] = rover.simulation.data.qpos.tolist()
        return state

    elsewhere = -2.0, 1.0, 2.0
    heavy, late = Variation(payload=3.0), Variation(latency=0.1)
    here = [(FREE, variation) for variation in (PLAIN, late, PLAIN, heavy, PLAIN)]
    with patch("harness.physics.physics.settle", side_effect=settle) as settling:
        counts, ends = [], []
        for start, variation in [(elsewhere, PLAIN), *here]:
            ends.append(driven(start, variation))
            counts.append(settling.call_count)
    assert counts == [1, 2, 2, 2, 3, 4]
    assert ends[1] == ends[2] == ends[3] == ends[5]
    assert ends[4] != ends[1] != ends[0]


def test_noise_of_all_sensors_is_of_the_episode_and_not_of_its_world(flat_with_post: Course) -> None:
    one, same, other = (DrivenRover(flat_with_post, FREE, PLAIN, seed).readings for seed in (0, 0, 1))
    for kind in (LaserScan, Imu, RangeReading):
        assert repr(one[kind]) == repr(same[kind]) != repr(other[kind])


def test_late_readings_are_those_of_some_periods_before(flat_with_post: Course) -> None:
    prompt, late = (DrivenRover(flat_with_post, FREE, Variation(latency=s), 0) for s in (0.0, 0.1))
    stamps = []
    for _ in range(4):
        read = [{rover.readings[kind].stamp_ns for kind in READ_AT_ITS_END} for rover in (prompt, late)]
        stamps.append(read)
        assert prompt.readings.keys() == late.readings.keys() == {*SENSED, RangeReading}
        for rover in (prompt, late):
            rover.advance(Twist(0.3, 0.0))
    periods = [(1, 1), (2, 1), (3, 1), (4, 2)]  # nothing is older than the first
    assert stamps == [[{n * NANOSECONDS // 20} for n in pair] for pair in periods]


def test_contact_with_a_hazard_counts_in_hundredths_of_a_second(flat_with_post: Course) -> None:
    rover, seconds = DrivenRover(flat_with_post, (0.0, 0.0, 0.0), PLAIN, 0), 0.0
    for _ in range(30):
        rover.advance(Twist(0.7, 0.0))
        touching = rover.simulation.data.contact.geom
        post = rover.simulation.model.geom("hazard_0").id
        assert (rover.hazard_s > 0.0) >= (post in touching)
        assert rover.hazard_s in [0.01 * n for n in range(6)]
        seconds += rover.hazard_s
    assert 0.1 < seconds < 1.4


def test_a_body_on_the_ground_is_a_scrape(flat_with_post: Course) -> None:
    rover, parts = DrivenRover(flat_with_post, (-2.0, 0.0, 0.0), PLAIN, 0), 0
    model, data = rover.simulation.model, rover.simulation.data
    scrapes = [model.sensor(n) for n in range(model.nsensor)]
    scrapes = [sensor for sensor in scrapes if sensor.name.startswith(SCRAPE_CONTACT)]
    for turn in Rotation.random(30, rng=np.random.default_rng(1)):  # on several parts at once, too
        data.qpos[2:7] = 0.05, *np.roll(turn.as_quat(), 1)
        data.qvel[:] = 0.0
        rover.advance(Twist())
        assert rover.scrape_s in [pytest.approx(0.01 * n) for n in range(6)]
        parts = max(parts, sum(rover.simulation.tick_sum[s.adr[0]] > 0 for s in scrapes))
    assert parts > 1
    data.qpos[2:7] = 0.35, 0.0, 1.0, 0.0, 0.0  # on its roof
    data.qvel[:] = 0.0
    for _ in range(6):
        rover.advance(Twist())
    assert (rover.scrape_s, rover.hazard_s) == pytest.approx((0.05, 0.0))


def test_a_start_in_an_obstacle_or_off_the_map_is_refused(flat_with_post: Course) -> None:
    for _ in range(2):  # not only at first
        with pytest.raises(UsageError, match="is inside hazard_0"):
            DrivenRover(flat_with_post, (0.6, 0.0, 0.0), PLAIN, 0)
    with pytest.raises(UsageError, match="off the map"):
        DrivenRover(flat_with_post, (9.0, 0.0, 0.0), PLAIN, 0)
    rover = DrivenRover(flat_with_post, (3.4, 0.0, 0.0), PLAIN, 0)
    rover.simulation.data.qpos[0] = 3.49  # 1 cm
    rover.simulation.data.qvel[0] = 0.5
    before = rover.readings[Pose]
    with pytest.raises(RunFailed, match="edge of the map"):
        rover.advance(Twist(0.7, 0.0))
    assert rover.readings[Pose] is before


def test_a_variation_changes_the_rover_alone_and_only_for_its_episode(flat_with_post: Course) -> None:
    variation = Variation(friction=0.5, mass=1.2, payload=3.0, motor_strength=0.25)
    plain = flat_with_post.scene.model
    before = {name: getattr(plain, name).copy() for name in VARIED}
    model = flat_with_post.varied(FREE, variation).model
    base = plain.body("rover").id
    assert model.body_subtreemass[base] == pytest.approx(
        1.2 * plain.body_subtreemass[base] + 3.0
    )  # [kg]
    of_rover = plain.body_rootid == base
    own = of_rover[plain.geom_bodyid]
    assert own.any()
    assert not own[[plain.geom("hazard_0").id, plain.geom("terrain").id]].any()
    masses = np.where(of_rover, 1.2, 1.0)
    factors = np.where(own[:, None], (0.5, 1.0, 1.0), 1.0), masses, masses[:, None], 0.25
    expected = {name: factor * before[name] for name, factor in zip(VARIED, factors, strict=True)}
    expected["body_mass"][base] += 3.0
    for name in VARIED:
        assert getattr(model, name).tolist() == expected[name].tolist(), name
        assert getattr(plain, name).tolist() == before[name].tolist(), name
    # A settled rover presses on the ground with its weight.
    data = DrivenRover(flat_with_post, FREE, variation, 0).simulation.data
    force, total = np.empty(6), 0.0
    for index in range(data.ncon):
        mujoco.mj_contactForce(model, data, index, force)
        total += force[0]
    assert total == pytest.approx(model.body_subtreemass[base] * 9.8, rel=0.01)


def test_a_draw_is_within_the_ranges_and_one_range_leaves_the_others_draws_alone() -> None:
    wide = Randomisation(friction=(0.5, 1.5), payload=(1.0, 2.0), latency=(0.0, 0.2))
    draws = [draw_variation(wide, np.random.default_rng(seed)) for seed in range(50)]
    for name, (low, high) in vars(wide).items():
        values = [getattr(draw, name) for draw in draws]
        share = 0.1 * (high - low)
        assert low <= min(values) <= low + share
        assert high - share <= max(values) <= high
    assert {draw.late_periods for draw in draws} == {0, 1, 2, 3, 4}
    assert draw_variation(Randomisation(), np.random.default_rng(0)) == PLAIN
    narrow = draw_variation(Randomisation(latency=(0.0, 0.2)), np.random.default_rng(0))
    assert narrow.latency == draws[0].latency
