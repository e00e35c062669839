from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.drivers import DRIVERS, find_driver, takes_goals
from harness.drivers.base import DriverContext, Observation
from harness.drivers.point_nav import SENSED, commanded
from harness.drivers.policy import BESIDE_LIDAR, Policy, read_policy, write_policy
from harness.episode.episode import Episode
from harness.robots import RoverSpec, find_rover
from harness.samples import Imu, LaserScan, Odometry, Pose, Twist
from harness.spec.run import Run

BEAMS = 16
GENERATOR = np.random.default_rng(0)
SIZES = ((BEAMS + BESIDE_LIDAR, 8), (8, 2))
LAYERS = tuple(
    (
        GENERATOR.normal(0.0, 0.3, s).astype(np.float32),
        GENERATOR.normal(0.0, 0.1, s[1]).astype(np.float32),
    )
    for s in SIZES
)


@pytest.fixture
def policy(tmp_path: Path) -> Path:
    path = tmp_path / "small.npz"
    write_policy(path, Policy(LAYERS))
    return path


@pytest.mark.parametrize("activation", ["tanh", "relu"])
def test_a_policy_is_the_network_that_was_written(tmp_path: Path, activation: str) -> None:
    path = tmp_path / "small.npz"
    write_policy(path, Policy(LAYERS, activation))
    read = read_policy(str(path))
    assert read.beams == BEAMS
    sizes = {"velocities": 2, "lidar": BEAMS, "imu": 8, "goal": 3}
    seen = {name: np.linspace(-1.0, 1.0, size, dtype=np.float32) for name, size in sizes.items()}
    flat = np.concatenate([seen["goal"], seen["imu"], seen["lidar"], seen["velocities"]]).astype(float)
    hidden = flat @ LAYERS[0][0] + LAYERS[0][1]
    hidden = np.tanh(hidden) if activation == "tanh" else hidden * (hidden > 0.0)
    assert read.act(seen) == pytest.approx(
        np.clip(hidden @ LAYERS[1][0] + LAYERS[1][1], -1, 1), abs=1e-5
    )
    loud = Policy((LAYERS[0], (1e3 * LAYERS[1][0], LAYERS[1][1])))
    assert set(np.abs(loud.act(seen)).tolist()) == {1.0}


def test_it_stands_until_it_has_a_goal_and_has_read_everything_and_at_the_goal(policy: Path) -> None:
    made = find_driver(f"policy:{policy}")
    context = DriverContext(find_rover("leo"), (20.0, 20.0), np.zeros(BEAMS), np.random.default_rng(0))
    driver = made(context)
    seen = Observation(
        0, 0.0, 0.0, 0.0, None, readings={LaserScan: LaserScan(0, np.ones(BEAMS, np.float32))}
    )
    assert driver.command(seen) == Twist()
    driver.head_for(1.0, 2.0, 0.0)  # type: ignore[attr-defined]
    assert driver.command(seen) == Twist()
    unturned = (0.0, 0.0, 0.0, 1.0)
    readings = {
        **seen.readings,
        Imu: Imu(0, unturned, (0.0, 0.0, 0.0), (0.0, 0.0, 9.81)),
        Pose: Pose(0, (0.0, 0.0, 0.0), unturned),
        Odometry: Odometry(0, 0.0, 0.0, 0.0, Twist()),
    }
    stands = []
    for x in (0.51, -0.49, 0.51):  # goals count as reached within 0.5 m
        driver.head_for(x, 0.0, 0.0)  # type: ignore[attr-defined]
        stands.append(driver.command(replace(seen, readings=readings)) == Twist())
    assert stands == [False, True, False]
    with pytest.raises(UsageError, match=r"for 16 beams, the lidar has 640; give --lidar-beams 16"):
        made(replace(context, bearings=np.zeros(640)))


def test_an_action_is_a_share_of_the_largest_speeds() -> None:
    rover = find_rover("leo")  # 12 rad/s on wheels of 6.25 cm
    assert commanded([0.5, -1.0], rover) == Twist(0.5 * 0.75, -1.0 * rover.cruise_yaw_rate)


def test_a_rover_that_steers_gets_a_policys_command_as_in_its_environment(
    tmp_path: Path, foreign: Callable[[str], RoverSpec]
) -> None:
    """To turn on the spot it stands, where other drivers back up in a curve."""
    weights, turning = np.zeros((BEAMS + BESIDE_LIDAR, 2), np.float32), np.array([0.0, 1.0], np.float32)
    write_policy(tmp_path / "turn.npz", Policy(((weights, turning),)))
    run = Run.of(
        terrain="flat", robot=str(foreign("buggy").folder), lidar_beams=BEAMS, duration=2.0,
        driver=f"policy:{tmp_path / 'turn.npz'}", goals=((0.0, 3.0, 0.0, 0.0),),
    )  # fmt: skip
    *_, last = Episode(run).batches()
    assert last.truth.path_length < 0.1


def test_drivers_say_what_they_look_at_and_whether_they_take_goals(policy: Path) -> None:
    names = (f"policy:{policy}", "goal", "spin")
    assert [find_driver(name).senses for name in names] == [SENSED, {LaserScan}, set()]
    assert [takes_goals(name) for name in names] == [True, True, False]


BAD: list[tuple[dict[str, np.ndarray | None], str]] = [
    ({"bias_1": None}, "lacks bias_1; see docs/gym.md"),
    ({"weights_0": None, "weights_1": None}, "lacks weights_0; see docs/gym.md"),
    ({"activation": None}, "lacks activation"),
    ({"activation": np.array("swish")}, "activation 'swish' does not exist; available: tanh, relu"),
    ({"bias_0": np.zeros(3)}, "layer 0 of (29, 8) and (3,) does not take 29 numbers"),
    ({"weights_1": np.zeros((9, 2))}, "layer 1 of (9, 2) and (2,) does not take 8 numbers"),
    ({"weights_1": np.zeros((8, 3)), "bias_1": np.zeros(3)}, "spaces, 29 inputs and 3 outputs"),
    ({"bias_1": np.array([0.0, np.nan])}, "2 outputs, and finite numbers"),
    ({}, "is no .npz file of arrays"),
]


@pytest.mark.parametrize(("changes", "message"), BAD)
def test_a_file_without_a_policy_is_one_line_that_says_why(
    policy: Path, changes: dict[str, np.ndarray | None], message: str
) -> None:
    arrays = dict(np.load(policy)) | changes
    wrong = policy.with_name("wrong.npz")
    np.savez(wrong, **{name: array for name, array in arrays.items() if array is not None})
    if not changes:
        wrong.write_text("hello")
    for name in (wrong, wrong.with_name("nowhere.npz")):
        with pytest.raises(UsageError, match=f"^policy {name} ?") as raised:
            find_driver(f"policy:{name}")
        assert "\n" not in str(raised.value)
        assert (message if name == wrong else "cannot be read: No such file") in str(raised.value)


def test_drivers_are_found_by_name_and_an_unknown_one_is_refused_with_the_names() -> None:
    assert all(find_driver(name) is driver for name, driver in DRIVERS.items())
    assert len({driver.summary for driver in DRIVERS.values()}) == len(DRIVERS)
    with pytest.raises(UsageError, match=f"^driver 'drunk' .*; available: {', '.join(DRIVERS)}$"):
        find_driver("drunk")
