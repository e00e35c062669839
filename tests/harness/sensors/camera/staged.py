"""What a camera sees in tests: a ball over flat ground. A module of its own, for other processes."""

import math
from importlib import import_module

import numpy as np

from harness.physics.berths import Member
from harness.robots import find_rover
from harness.sensors.camera.sensor import CameraOptions
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World

BALL, RADIUS = (2.5, -0.6, 1.9), 0.3  # [m]
EYE = (0.4, 0.1, 1.5)  # [m]
CAMERAS = {
    "pinhole": CameraOptions(name="pinhole", width=120, height=90, fov=1.1),
    "fisheye": CameraOptions(name="fisheye", lens="fisheye", width=200, height=100, fov=2.8),
    "noisy": CameraOptions(name="noisy", width=120, height=90, fov=1.1, noise=0.02),
    "noisy_too": CameraOptions(name="noisy_too", width=120, height=90, fov=1.1, noise=0.02),
}


def scenery() -> tuple[World, tuple[Member, ...]]:
    """The ball, and a rover behind the camera."""
    ground = Heightfield(np.zeros((25, 25)), 0.5)
    ball = Obstacle(ObstacleKind.HAZARD, "ellipsoid", (RADIUS,) * 3, BALL)
    rover = Member("", find_rover("leo"), (0.0, 0.0, 0.0))
    return World("stage", ground, (ball,), seed=0, difficulty=0.0), (rover,)


def coarse_scenery() -> tuple[World, tuple[Member, ...]]:
    """The same for a process of its own, without the grain of the soil, which takes a second."""
    stage = import_module("harness.physics.stage")
    stage.SOIL_PIXELS = 64  # type: ignore[attr-defined]  # a module's
    return scenery()


def looking(yaw: float = 0.0, pitch: float = 0.0) -> tuple[float, float, float, float]:
    """Orientation (x, y, z, w) of the optical frame of a camera that looks along x, then turned."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 - the process that draws needs none

    turned = Rotation.from_euler("ZYX", (yaw, pitch, 0.0))
    optical = Rotation.from_euler("xyz", (-math.pi / 2, 0.0, -math.pi / 2))
    x, y, z, w = (turned * optical).as_quat().tolist()
    return x, y, z, w
