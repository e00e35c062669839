"""Scenes made for measuring: hills of a given size and cell with a given number of obstacles."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.scene import Scene, build_scene
from harness.robots import find_rover
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Form, ObstacleKind, Shape, place, scatter
from harness.world.world import World

TIMESTEP = 0.0025  # [s]
HILL_HEIGHT, HILL_LENGTH = 1.2, 12.0  # [m]
RIPPLE_HEIGHT = 0.02  # [m] of random height on top
SHAPES: tuple[Shape, ...] = ("ellipsoid", "box", "cylinder")
EDGE = 1.0  # [m]
SEED = 0


def hills(size: float, cell: float, obstacles: int, height: float = HILL_HEIGHT) -> World:
    """Hills, by default higher than a lidar: its beams end in them or fly between them.

    Args:
        size: Side length of the map [m].
        cell: Distance of two vertices [m].
        obstacles: Ellipsoids, boxes and cylinders in equal parts.
        height: Amplitude of the hills [m] along x and along y.
    """
    rng = np.random.default_rng(SEED)
    axis = np.linspace(-size / 2, size / 2, round(size / cell) + 1)
    x, y = np.meshgrid(axis, axis)
    waves = np.cos(2 * np.pi * x / HILL_LENGTH) + np.sin(2 * np.pi * y / HILL_LENGTH)
    ground = Heightfield(height * waves + rng.uniform(0, RIPPLE_HEIGHT, x.shape), cell)
    places = scatter(rng, obstacles, reach=size / 2 - EDGE, spacing=0.3, keep_out=1.5)
    assert len(places) == obstacles, "the map is too small for that many obstacles"
    stones = tuple(place(_stone(i, rng), ground, x, y) for i, (x, y) in enumerate(places))
    return World("hills", ground, stones, SEED, 0.5)


def _stone(index: int, rng: np.random.Generator) -> Form:
    shape = SHAPES[index % len(SHAPES)]
    a, b, c = rng.uniform(0.04, 0.12, 3).tolist()
    size = (a, b) if shape == "cylinder" else (a, b, c)
    return Form(kind=ObstacleKind.ROCK, shape=shape, half_size=size, yaw=rng.uniform(0, np.pi))


def scene_on_hills(size: float, cell: float, obstacles: int, height: float = HILL_HEIGHT) -> Scene:
    """A Leo in such a world."""
    return build_scene(hills(size, cell, obstacles, height), find_rover("leo"), TIMESTEP)


def poses(scene: Scene, count: int) -> list[mujoco.MjData]:
    """States of the scene with the rover set down at random places, slightly tilted."""
    rng = np.random.default_rng(SEED)
    return [_posed(scene, rng) for _ in range(count)]


def _posed(scene: Scene, rng: np.random.Generator) -> mujoco.MjData:
    data = mujoco.MjData(scene.model)
    ground = scene.world.ground
    x, y = rng.uniform(-0.3, 0.3, 2) * 2 * ground.half_size
    data.qpos[:7] = [x, y, ground.height_at(x, y), *_attitude(rng)]
    mujoco.mj_kinematics(scene.model, data)
    return data


def _attitude(rng: np.random.Generator) -> NDArray[np.float64]:
    heading, tilt_x, tilt_y = rng.uniform(-np.pi, np.pi), *rng.normal(0, 0.05, 2)
    quaternion = np.array([np.cos(heading / 2), tilt_x, tilt_y, np.sin(heading / 2)])
    unit: NDArray[np.float64] = quaternion / np.linalg.norm(quaternion)
    return unit
