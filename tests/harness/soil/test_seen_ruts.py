"""Ruts in what sensors read, against the bed's own heights."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from harness.episode.episode import Episode
from harness.physics.simulation import Simulation
from harness.spec.run import Run


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
