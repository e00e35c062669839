import math
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.drivers import find_driver
from harness.drivers.point_nav import observed
from harness.drivers.policy import Policy, write_policy
from harness.episode.episode import Episode
from harness.samples import Pose
from tests.harness.gym.conftest import Make, MakeConfig, place

WEIGHTS = {"progress": 3.0, "reached": 7.0, "time": -0.5, "hazard": -2.0, "scrape": -4.0}
WEIGHTS |= {"flipped": -9.0, "action_rate": -0.25}
DEFAULTS = {"progress": 1.0, "reached": 10.0, "time": -0.01, "hazard": -10.0, "scrape": -1.0}
DEFAULTS |= {"flipped": -10.0, "action_rate": -0.01}
FAR = {"start": (-0.2, 0.0, 0.0), "goal": (4.0, 3.0)}


def driven(env: Any, steps: int = 60) -> list[tuple[Any, ...]]:  # noqa: ANN401
    """Drives against the wall; each step's result with the contacts of hazards and body [s]."""
    told: list[tuple[Any, ...]] = []
    rng = np.random.default_rng(2)
    env.reset(seed=1, options=FAR)
    while not told or (len(told) < steps and not told[-1][4]["ending"]):
        action = np.array([0.5, 0.0]) + rng.uniform(-0.1, 0.1, 2)
        told.append((*env.step(action), env.driven.hazard_s, env.driven.scrape_s, action))
    return told


@pytest.mark.parametrize("weights", [DEFAULTS, WEIGHTS])
def test_each_step_is_paid_by_what_the_simulator_did(
    make_fenced: Make, weights: dict[str, float]
) -> None:
    own = {} if weights is DEFAULTS else {"reward": weights}
    env = make_fenced(hazard_budget=9.0, **own)
    for _ in range(2):  # what an episode had of everything is not the next one's
        before, acted, touched = 0.0, np.zeros(2), 0.0
        for n, (_, reward, *_, info, hazard_s, scrape_s, action) in enumerate(driven(env)):
            here = info["x_position"], info["y_position"]
            distance, touched = math.dist((4.0, 3.0), here), touched + hazard_s
            measured = {
                "progress": before - distance,
                "reached": 0.0,
                "time": 1.0,
                "hazard": hazard_s,
                "scrape": scrape_s,
                "flipped": float(info["ending"] == "flipped"),
                "action_rate": float(np.abs(action.clip(-1, 1) - acted).sum()),
                "sinkage": 0.0,
                "stuck": 0.0,
            }
            terms = {name: weights.get(name, 0.0) * value for name, value in measured.items()}
            if n:
                assert info["reward_terms"] == pytest.approx(terms, abs=1e-12)
            assert reward == pytest.approx(sum(info["reward_terms"].values()))
            assert (info["distance"], info["hazard_s"]) == pytest.approx((distance, touched))
            assert info["is_success"] is False
            before, acted = distance, action.clip(-1, 1)
        assert here == tuple(env.driven.simulation.data.qpos[:2])
        assert touched > 0.3


def test_the_budget_of_contact_with_hazards_ends_an_episode(make_fenced: Make) -> None:
    seconds = [told[5] for told in driven(make_fenced(hazard_budget=9.0))]
    sums = np.cumsum(seconds)
    last = next(n for n in range(60) if sums[n] > 0.3 and seconds[n + 1])
    for slack, ends in ((0.0, last), (1e-12, last), (2e-9, last + 1)):  # a sum of hundredths
        told = driven(make_fenced(hazard_budget=float(sums[last]) + slack))
        assert len(told) == ends + 1
        assert (*told[-1][2:4], told[-1][4]["ending"]) == (True, False, "hazard")


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


@pytest.mark.parametrize(
    ("goal", "x", "roll", "speed", "ending"),
    [
        (0.29, 0.0, None, 0.0, "reached"),
        (0.35, 0.0, None, 0.0, ""),
        (2.0, 0.0, 74.0, 0.0, ""),
        (2.0, 0.0, 76.0, 0.0, "flipped"),
        (0.1, 0.0, 80.0, 0.0, "flipped"),  # nobody reaches a goal on the side
        (2.0, 6.6, None, 0.0, "edge"),  # the map ends at 7 m
        (6.6, 6.6, None, 0.0, "reached"),
        (0.1, 0.0, 80.0, math.nan, "diverged"),  # what is no state has no place and no tilt
    ],
)
def test_what_the_physics_comes_to_ends_episodes(
    make: Make, goal: float, x: float, roll: float | None, speed: float, ending: str
) -> None:
    env = make(goal_radius=0.3, time_limit=0.05)
    env.reset(options={"start": (0.0, 0.0, 0.0), "goal": (goal, 0.0)})
    simulation = env.driven.simulation
    if roll is None:
        simulation.data.qpos[0] += x
    else:
        place(env, (x, 0.0), 1.0, (0.0, 0.0, math.radians(roll)))
    simulation.data.qvel[0] = speed
    seen, reward, *told, info = env.step(np.zeros(2, np.float32))
    ended = ending in ("reached", "flipped")
    assert (info["ending"], info["is_success"]) == (ending or "time", ending == "reached")
    assert told == [ended, not ended]
    assert all(np.isfinite(part).all() for part in seen.values())
    paid = info["reward_terms"]
    if ending == "diverged":
        assert (paid["progress"], info["distance"]) == (0.0, pytest.approx(goal, abs=0.01))
    else:
        assert (info["x_position"], info["y_position"]) == tuple(simulation.data.qpos[:2])
        there = math.dist(simulation.data.qpos[:2], (goal, 0.0))
        assert info["distance"] == pytest.approx(there)
        assert paid["progress"] == pytest.approx(goal - there, abs=0.01)
    goals, flips = 10.0 * (ending == "reached"), -10.0 * (ending == "flipped")
    assert (paid["reached"], paid["flipped"]) == (goals, flips)
    assert math.isfinite(reward)


def test_what_is_observed_is_what_was_read(make: Make) -> None:
    env = make(height_scan=True)
    env.reset(seed=2)
    for yaw in (0.5, -2.5):
        place(env, (0.5, 0.3), 0.3, (yaw, 0.2, -0.3))
        seen, *_ = env.step(np.array([0.5, 1.0]))
        expected = observed(env.driven.readings, env.goal, 10.0)
        assert all(seen[name] == pytest.approx(np.array(value)) for name, value in expected.items())
        pose = env.driven.readings[Pose]
        turn = Rotation.from_quat(pose.orientation).as_euler("ZYX")[0]
        ahead = np.add(pose.position[:2], 1.5 * np.array([math.cos(turn), math.sin(turn)]))
        height = env.course.scene.world.ground.height_at(*ahead) - pose.position[2]
        assert seen["heights"].reshape(11, 7)[-1, 3] == pytest.approx(height, abs=1e-4)


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
    for row, column in np.ndindex(height, width):
        left, above = ((width - 1) / 2 - column) / focal, ((height - 1) / 2 - row) / focal
        ray = axis + left * np.array([0.0, 1.0, 0.0]) + above * up
        length = np.linalg.norm(ray)
        met = mujoco.mj_ray(model, data, origin, turn @ (ray / length), groups, 1, -1, geom, None)
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
    plain = Episode(
        run, samples=find_driver(run.rover.driver).senses
    )  # as a run without a log reads them
    assert [plain.simulation.data.qpos.tolist() for _ in plain.batches()] == driven
