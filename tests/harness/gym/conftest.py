"""Environments on a small map: ready in a fraction of a second."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import harness.gym  # noqa: F401 - registers
from harness.drivers.policy import BESIDE_LIDAR, Policy
from harness.spec.run import Run
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World
from tests.support.forking import ForkServer

SIDE, VERTICES = 14.0, 57  # [m], a vertex every 25 cm

Make = Callable[..., Any]
MakeConfig = Callable[..., Run]


@pytest.fixture(scope="session", autouse=True)
def _forked_environments() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:  # test_processes.py has scripts that spawn theirs
        patch.setattr("harness.gym.many.multiprocessing", ForkServer())
        yield


@pytest.fixture(scope="session")
def bumpy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A heightmap: bumps of a few centimetres, level around its middle, with a rim to be seen."""
    rng, axis = np.random.default_rng(0), np.linspace(-1.0, 1.0, VERTICES)
    radius = np.hypot(*np.meshgrid(axis, axis))
    far, rim = radius > 0.15, 6.0 * np.maximum(radius - 0.8, 0.0)
    path = tmp_path_factory.mktemp("maps") / "bumpy.npy"
    np.save(path, np.where(far, rim + 0.03 * rng.random((VERTICES, VERTICES)), 0.015))
    return path


@pytest.fixture(scope="session")
def small(bumpy: Path) -> dict[str, Any]:
    """The options of an environment there."""
    return {
        "robot": "rover_zero4wd",
        "terrain": str(bumpy),
        "terrain_size": SIDE,
        "lidar_beams": 32,
        "goal_distance": (1.0, 4.0),
    }


@pytest.fixture(scope="session")
def make(small: dict[str, Any]) -> Make:
    """Makes an environment there by the name in its id, without Gymnasium's wrappers."""

    def made(name: str = "PointNav", **options: object) -> Any:  # noqa: ANN401 - of any kind
        return gymnasium.make(f"RoverHarness/{name}-v0", **{**small, **options}).unwrapped

    return made


@pytest.fixture
def make_fenced(make: Make, monkeypatch: pytest.MonkeyPatch) -> Make:
    """Makes an environment on level ground with a wall to drive against."""
    ground, wall = Heightfield(np.zeros((57, 57)), 0.25), (0.1, 1.5, 0.5)
    hazard = Obstacle(ObstacleKind.HAZARD, "box", wall, (0.6, 0.0, 0.5))
    world = World("fenced", ground, (hazard,), seed=0, difficulty=None)
    monkeypatch.setattr("harness.gym.course.world_of", lambda _: world)
    return make


@pytest.fixture(scope="session")
def config(small: dict[str, Any]) -> MakeConfig:
    """Makes episodes of `harness.run` there, with noise."""
    there = {name: small[name] for name in ("robot", "terrain", "lidar_beams")}
    there |= {"terrain_size": (SIDE, SIDE), "noise": "hardware"}
    return lambda **options: Run.of(**{**there, **options})


@pytest.fixture(scope="session")
def policy(small: dict[str, Any]) -> Policy:
    """One of six hidden units that was never trained."""
    rng, shapes = np.random.default_rng(1), ((BESIDE_LIDAR + small["lidar_beams"], 6), (6, 2))
    weights = [(rng.normal(0.0, 0.2, shape), rng.normal(0.0, 0.3, shape[1])) for shape in shapes]
    return Policy(tuple((w.astype(np.float32), b.astype(np.float32)) for w, b in weights))


def place(env: Any, where: Any, height: float, angles: tuple[float, float, float]) -> None:  # noqa: ANN401
    """Sets the rover of an environment down, with its wheels as they turn.

    Args:
        env: The environment, in an episode.
        where: x, y in the world [m].
        height: Of its model frame over the ground [m].
        angles: Yaw, pitch, roll [rad].
    """
    simulation = env.driven.simulation
    x, y = map(float, where)
    ground = simulation.scene.world.ground.height_at(x, y)
    turn = Rotation.from_euler("ZYX", angles).as_quat()
    simulation.data.qpos[:7] = x, y, ground + height, *np.roll(turn, 1)
    simulation.data.qvel[:6] = 0.0
