"""Ruts in what sensors read, against the bed's own heights."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from harness.episode.episode import Episode
from harness.physics.simulation import Simulation
from harness.sensors.depth import DepthOptions
from harness.sensors.lidars import CloudLidarOptions
from harness.sensors.ranging import RangeOptions, RangeSensor
from harness.sensors.rays.bundle import Surroundings
from harness.spec.run import Run
from tests.harness.sensors.installed import installation

# Over the ruts behind the rover, turned by half a turn and down: x of the lidar ahead, z of the camera.
BEHIND = (-0.9, 0.0, 0.6)
TURN = np.array(
    [[-math.cos(0.6), 0.0, -math.sin(0.6)], [0.0, -1.0, 0.0], [-math.sin(0.6), 0.0, math.cos(0.6)]]
)
CLOUD = CloudLidarOptions.model_validate(
    {"name": "cloud", "rings": 60, "lowest": -0.5, "highest": 0.5, "columns": 90}
    | {"angle_min": -0.5, "angle_max": 0.5}
)
OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    plan = {"driver": "cmd_vel", "commands": ((0.1, 0.3, 0.1),)}
    episode = Episode(Run.of(terrain="rolling", difficulty=0.3, soil="dry_sand", duration=6.0, **plan))
    for _ in episode.batches():
        pass
    return episode.simulation


def heights(
    simulation: Simulation, x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], ...]:
    """Of the bed with its ruts and of the terrain at places [m], by another interpolation."""
    ground, bed = simulation.ground, simulation.physics.bed
    assert bed is not None
    left, _, low, _ = ground.bounds()
    at = [(y - low) / ground.cell, (x - left) / ground.cell]
    with_ruts = map_coordinates(bed.surface, at, order=1)
    return with_ruts, simulation.scene.world.ground.heights_at(x, y)


def test_what_a_camera_is_shown_of_the_ground_is_what_lies_around_it(simulation: Simulation) -> None:
    (x, y, _), ground, bed = simulation.position, simulation.ground, simulation.physics.bed
    assert bed is not None
    shown = bed.around(x + 1.0, y - 3.0)
    assert shown is not None
    row, column, patch = shown
    left, _, low, _ = ground.bounds()
    xs, ys = (
        begin + ground.cell * np.arange(n)
        for begin, n in zip(
            (left + ground.cell * column, low + ground.cell * row), patch.shape[::-1], strict=True
        )
    )
    assert (xs.mean(), ys.mean()) == pytest.approx((x + 1.0, y - 3.0), abs=0.1)
    assert patch.ravel() == pytest.approx(heights(simulation, *map(np.ravel, np.meshgrid(xs, ys)))[0])


@pytest.mark.parametrize(
    ("options", "axes"),
    [
        (DepthOptions(name="depth", width=80, height=60), TURN @ OPTICAL),
        (CLOUD, TURN),
    ],
)
def test_points_of_depth_images_and_clouds_lie_on_the_bed(
    simulation: Simulation, options: RangeOptions, axes: NDArray[np.float64]
) -> None:
    body = simulation.model.body("rover").id
    mounted = installation(
        options, xyz=BEHIND, axes=axes, body=body, surroundings=Surroundings(simulation.model)
    )
    sensor = RangeSensor(simulation, mounted, 10)
    reading, pose = sensor.read(), sensor.pose()
    seen = np.isfinite(reading.ranges) & ~reading.on_obstacle & (reading.ranges < 2.0)
    points = pose[0] + (reading.ranges[:, None] * options.directions())[seen] @ pose[1:].T
    with_ruts, terrain = heights(simulation, *points[:, :2].T)
    assert seen.sum() > 500
    assert np.abs(points[:, 2] - with_ruts).max() < 0.004  # of cells that are split into triangles
    assert np.abs(points[:, 2] - with_ruts).mean() < 3e-4
    assert (points[:, 2] < terrain - 0.005).sum() > 50
