import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.drivers import sensed_by
from harness.drivers.policy import Policy, write_policy
from harness.episode.episode import Episode
from harness.samples import Imu, LaserScan, Odometry, Pose, Twist
from harness.sensors.depth import DepthOptions
from harness.sensors.ranging import RangeReading
from harness.world.heightfield import Heightfield
from tests.harness.gym.conftest import Make, MakeConfig

WEIGHTS = {"progress": 3.0, "reached": 7.0, "time": -0.5, "hazard": -2.0, "scrape": -4.0}
WEIGHTS |= {"flipped": -9.0, "action_rate": -0.25}
TOUCHING = 0.05  # [s] in each step of the table below
STEPS = [  # failure, tilt [deg], contact before [s], distance [m], ending; limits 75 deg, 0.3 s, 0.5 m
    ("", 0.0, 0.0, 0.5, ""),
    ("", 0.0, 0.0, 0.4999, "reached"),
    ("", 75.0, 0.0, 2.0, ""),
    ("", 75.001, 0.0, 2.0, "flipped"),
    ("", 180.0, 0.0, 2.0, "flipped"),
    ("", 0.0, 0.24, 2.0, ""),
    ("", 0.0, 0.25, 2.0, "hazard"),
    ("", 0.0, 0.25 - 1e-12, 2.0, "hazard"),  # a sum of hundredths
    ("", 0.0, 0.25 - 1.1e-9, 2.0, ""),
    ("", 0.0, 0.25, 0.1, "hazard"),  # nobody reaches a goal through a wall
    ("", 80.0, 0.25, 0.1, "flipped"),
    ("edge", 0.0, 0.25, 2.0, "edge"),  # the contacts of a step that broke off are not known
    ("edge", 0.0, 0.0, 0.1, "reached"),
    ("edge", 80.0, 0.0, 0.1, "flipped"),
    ("diverged", 80.0, 0.3, 0.1, "diverged"),  # what is no state has no place and no tilt
]


def riding(distance: float, tilt: float = 0.0, hazard_s: float = 0.0, scrape_s: float = 0.0) -> Any:  # noqa: ANN401
    """What is judged of a ride: so far north of the origin [m], tilted [deg]."""
    upright, place = math.cos(math.radians(tilt)), SimpleNamespace(position=(0.0, distance, 0.2))
    return SimpleNamespace(upright=upright, hazard_s=hazard_s, scrape_s=scrape_s, simulation=place)


def test_each_step_ends_and_is_paid_as_the_table_says(make: Make) -> None:
    env = make(reward=WEIGHTS, hazard_budget=0.3)
    env.goal = (0.0, 0.0)
    for failure, tilt, touched, distance, ending in STEPS:
        env._begin(riding(2.5))
        for _ in range(2):  # what an episode had of everything is not the next one's
            env._twist([0.5, -1.0])
            env._judge(riding(3.0, hazard_s=0.2), "")
            env._begin(riding(2.5))
        assert env._judge(riding(2.5, hazard_s=touched), "")[2]["hazard_s"] == touched
        env._twist([-0.25, 0.5])
        reward, told, info = env._judge(riding(distance, tilt, TOUCHING, 0.03), failure)
        seconds = (0.0, 0.0) if failure else (TOUCHING, 0.03)
        measured = {
            "progress": 0.0 if failure == "diverged" else 2.5 - distance,
            "reached": ending == "reached",
            "time": 1.0,
            "hazard": seconds[0],
            "scrape": seconds[1],
            "flipped": ending == "flipped",
            "action_rate": 0.75,
        }
        terms = {name: WEIGHTS[name] * value for name, value in measured.items()}
        case = (failure, tilt, touched, distance)
        assert (*case, told, info["is_success"]) == (*case, ending, ending == "reached")
        assert info["reward_terms"] == pytest.approx(terms), case
        assert reward == pytest.approx(sum(terms.values()))
        assert info["distance"] == (2.5 if failure == "diverged" else distance)
        assert info["hazard_s"] == touched + seconds[0]
        assert (info["x_position"], info["y_position"]) == (0.0, distance)
    usual = {"progress": 1.0, "reached": 10.0, "time": -0.01, "hazard": -10.0, "scrape": -1.0}
    assert vars(make().options.reward) == {**usual, "flipped": -10.0, "action_rate": -0.01}


def test_what_is_observed_is_what_was_read(make: Make) -> None:
    env, level = make(depth=(2, 2), height_scan=True), (0.0, 0.0, 0.0, 1.0)
    x, y, z, w = Rotation.from_euler("ZYX", [0.5, 0.2, -0.1]).as_quat().tolist()
    tilted = x, y, z, w
    readings = (
        LaserScan(0, np.array([np.nan, np.inf, -np.inf, *np.linspace(1.0, 8.0, 29)], np.float32)),
        Imu(0, tilted, (0.1, 0.2, 0.3), (1.0, 2.0, 9.5)),
        Pose(0, (1.0, 2.0, 0.5), level),
        Odometry(0, 0.0, 0.0, 0.0, Twist(0.1, 0.2)),
        RangeReading(0, "depth", np.array([np.nan, np.inf, -np.inf, 3.0], "f4"), np.zeros(4, np.bool_)),
    )
    slope, _ = np.meshgrid(0.1 * np.arange(-4.0, 5.0), np.arange(9))
    scene = SimpleNamespace(world=SimpleNamespace(ground=Heightfield(slope, 1.0)))
    ride = SimpleNamespace(
        readings={type(reading): reading for reading in readings},
        simulation=SimpleNamespace(scene=scene),
    )
    env.goal = (1.0, 5.0)
    seen = env._observe(ride)
    assert seen.keys() == env.observation_space.spaces.keys()
    assert seen["lidar"] == pytest.approx([10.0, 10.0, 0.0, *np.linspace(1.0, 8.0, 29)])
    assert seen["imu"] == pytest.approx((1.0, 2.0, 9.5, 0.1, 0.2, 0.3, -0.1, 0.2))  # roll, then pitch
    assert seen["velocities"] == (0.1, 0.2)
    assert seen["depth"].tolist() == [10.0, 10.0, 0.0, 3.0]  # a miss and a fault are the largest
    ahead = np.repeat(0.1 * (1.0 - 0.5 + 0.2 * np.arange(11)) - 0.5, 7)
    assert seen["heights"] == pytest.approx(ahead)
    assert seen["goal"] == pytest.approx((3.0, 1.0, 0.0))
    assert env.options.camera == DepthOptions(name="depth", width=2, height=2, rate=20)


@pytest.mark.parametrize("robot", ["leo", "rover_zero4wd"])
def test_full_ahead_is_the_speed_at_which_the_wheels_turn_as_fast_as_they_can(
    make: Make, robot: str
) -> None:
    env = make(robot=robot, random_start=False)
    env.reset(seed=0)
    for _ in range(20):
        seen, *_ = env.step(np.array([1.0, 0.0], np.float32))
    simulation = env.driven.simulation
    rover, limit = simulation.scene.rover, simulation.model.actuator_ctrlrange[0, 1]
    radius, believed = rover.wheel_radius, rover.controller_radius
    assert simulation.data.ctrl[0] * believed == pytest.approx(limit * radius)
    assert seen["velocities"][0] == pytest.approx(limit * radius, rel=0.1)


def rolled(degrees: float) -> list[float]:
    """Height [m] and attitude of a rover in the air."""
    half = math.radians(degrees) / 2
    return [1.0, math.cos(half), math.sin(half), 0.0, 0.0]


def test_what_the_physics_comes_to_ends_episodes(make: Make) -> None:
    env = make(goal_radius=0.3)
    for x, state, first, values, ending, ended in (  # the goal; what is changed from where on
        (0.29, "qpos", 0, [], "reached", [True, False]),
        (0.35, "qpos", 0, [], "", [False, False]),
        (0.35, "qpos", 2, rolled(69.0), "", [False, False]),
        (0.35, "qpos", 2, rolled(80.0), "flipped", [True, False]),
        (2.0, "qpos", 0, [6.6], "edge", [False, True]),  # the map ends at 7 m
        (2.0, "qvel", 0, [np.nan], "diverged", [False, True]),
    ):
        env.reset(options={"start": (0.0, 0.0, 0.0), "goal": (x, 0.0)})
        data = env.driven.simulation.data
        getattr(data, state)[first : first + len(values)] = values
        seen, reward, *told, info = env.step(np.zeros(2, np.float32))
        assert (info["ending"], told, info["is_success"]) == (ending, ended, ending == "reached")
        assert all(np.isfinite(part).all() for part in seen.values())
        assert math.isfinite(reward)
        if ending != "diverged":
            assert (info["x_position"], info["y_position"]) == tuple(data.qpos[:2])
            assert info["distance"] == pytest.approx(math.dist(data.qpos[:2], (x, 0.0)))
            assert info["reward_terms"]["progress"] == pytest.approx(x - info["distance"], abs=0.05)


def test_depth_is_what_mujocos_rays_meet_along_the_axis_of_a_camera_above_the_lidar(make: Make) -> None:
    width, height = 8, 6
    env = make(depth=(width, height))
    assert make().observation_space.spaces.keys() == env.observation_space.spaces.keys() - {"depth"}
    seen, _ = env.reset(seed=3)
    seen, *_ = env.step(np.array([0.5, 0.5], np.float32))
    simulation = env.driven.simulation
    model, data = simulation.model, simulation.data
    mujoco.mj_kinematics(model, data)
    turn, origin = data.body("rover").xmat.reshape(3, 3), data.site("lidar").xpos
    down, focal = 0.35, width / 2 / math.tan(1.047 / 2)
    axis = np.array([math.cos(down), 0.0, -math.sin(down)])  # x ahead, y left, z up
    up = np.array([math.sin(down), 0.0, math.cos(down)])
    groups, geom, expected = np.array([1, 0, 0, 0, 0, 1], np.uint8), np.zeros(1, np.int32), []
    for row in range(height):
        for column in range(width):
            left, above = ((width - 1) / 2 - column) / focal, ((height - 1) / 2 - row) / focal
            ray = axis + left * np.array([0.0, 1.0, 0.0]) + above * up
            length = np.linalg.norm(ray)
            ray = turn @ (ray / length)
            met = mujoco.mj_ray(model, data, origin, ray, groups, 1, -1, geom, None)
            expected.append(min(met / length, 10.0) if met >= 0.0 else 10.0)
    np.testing.assert_allclose(seen["depth"], expected, atol=1e-4)
    image = seen["depth"].reshape(height, width)
    assert (image[0] > image[-1]).all()  # the top row sees farther
    assert len({*np.round(seen["depth"], 3)}) > 2 * width


@pytest.mark.parametrize("robot", ["leo", "rover_zero4wd"])
def test_a_policy_drives_the_same_path_in_the_environment_and_as_driver(
    make: Make, config: MakeConfig, policy: Policy, tmp_path: Path, robot: str
) -> None:
    path, goal, seed = tmp_path / "small.npz", (2.0, 1.0), 4
    write_policy(path, policy)
    with pytest.raises(UsageError, match="made for other spaces: it takes 45 numbers, not 44"):
        policy.act({"lidar": np.zeros(44, np.float32)})
    env = make(robot=robot, noise="hardware", random_start=False)
    seen, _ = env.reset(seed=seed, options={"goal": goal})
    driven = [env.driven.simulation.data.qpos.tolist()]
    for _ in range(15):
        seen, *_ = env.step(policy.act(seen))
        driven.append(env.driven.simulation.data.qpos.tolist())
    run = config(robot=robot, seed=seed, duration=0.05 * 16, driver=f"policy:{path}")
    run = run.alone(goals=((0.0, *goal, 0.0),))
    episode = Episode(run)
    assert [episode.simulation.data.qpos.tolist() for _ in episode.batches()] == driven
    assert math.dist(driven[0][:2], driven[-1][:2]) > 0.02  # it does not just stand
    plain = Episode(run, samples=sensed_by(run.rover.driver))  # as a run without a log reads them
    assert [plain.simulation.data.qpos.tolist() for _ in plain.batches()] == driven
