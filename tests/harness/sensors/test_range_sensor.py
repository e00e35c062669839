"""Readings of optional lidars and depth cameras, by closed forms."""

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.physics.simulation import Simulation
from harness.sensors.corruption import RangeErrors
from harness.sensors.depth import DepthOptions
from harness.sensors.noise import NoisePreset
from harness.sensors.ranging import RangeSensor
from harness.sensors.rays.bundle import Surroundings
from harness.world.obstacles import Obstacle, ObstacleKind
from tests.harness.conftest import MakeSimulation
from tests.harness.sensors.installed import installation

AHEAD = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])  # optical axes in the base's
WALL = Obstacle(ObstacleKind.HAZARD, "box", (0.1, 3.0, 3.0), (1.6, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))


def camera(
    simulation: Simulation,
    options: DepthOptions,
    place: tuple[float, float, float],
    noise: NoisePreset | None = None,
) -> RangeSensor:
    """A level depth camera at a place in the world that looks along x."""
    body = simulation.model.body("rover").id
    turn: NDArray[np.float64] = simulation.data.xmat[body].reshape(3, 3)
    x, y, z = (turn.T @ (place - simulation.data.xpos[body])).tolist()
    around = Surroundings(simulation.model)
    installed = installation(
        options, 0, noise, (x, y, z), turn.T @ AHEAD, body=body, surroundings=around
    )
    return RangeSensor(simulation, installed, 10)


def test_the_depth_of_flat_ground_is_that_of_the_pinhole(make_simulation: MakeSimulation) -> None:
    """A level camera h above the plane sees it in row v at the depth h * f / (v - c)."""
    options = DepthOptions(name="depth", width=8, height=6)
    reading = camera(make_simulation(heights=np.zeros((201, 201))), options, (0.0, 0.0, 0.6)).read()
    image, below = reading.ranges.reshape(6, 8), np.arange(6) - 2.5
    assert (image[below < 0] == np.inf).all()
    expected = 0.6 * 4.0 / np.tan(0.5 * options.fov) / below[below > 0]
    assert image[below > 0] == pytest.approx(np.tile(expected, (8, 1)).T, rel=1e-5)
    assert reading.sensor == "depth"
    assert not reading.on_obstacle.any()


def test_a_wall_ahead_has_the_same_depth_in_the_whole_image(make_simulation: MakeSimulation) -> None:
    simulation = make_simulation(obstacles=(WALL,))
    options = DepthOptions(name="eye", width=6, height=4, fov=1.2, range_max=1.45)
    sensor = camera(simulation, options, (0.1, 0.0, 0.9))
    reading = sensor.read()
    simulation.data.qpos[0] -= 1.0
    assert not sensor.read().on_obstacle.any()  # which leaves the first reading as it is
    simulation.data.qpos[0] += 1.0
    assert reading.ranges == pytest.approx(np.full(24, 1.4, np.float32), abs=2e-3)
    assert reading.on_obstacle.all()
    near = camera(simulation, options.but(range_min=1.42), (0.1, 0.0, 0.9)).read()
    assert (near.ranges == -np.inf).all()


def test_a_lost_pixel_is_nan_and_not_a_miss(make_simulation: MakeSimulation) -> None:
    """REP-118: NaN is no measurement, +inf is nothing within range; the same pixels are lost."""
    options = DepthOptions(name="eye", width=40, height=30, fov=1.2, noise=RangeErrors(dropout=0.2))
    lost = camera(make_simulation(obstacles=(WALL,)), options, (0.1, 0.0, 0.9)).read().ranges
    exact = (
        camera(make_simulation(obstacles=(WALL,)), options.but(noise=RangeErrors()), (0.1, 0.0, 0.9))
        .read()
        .ranges
    )
    assert np.isnan(lost).mean() == pytest.approx(0.2, abs=0.04)
    np.testing.assert_array_equal(np.where(np.isnan(lost), exact, lost), exact)
