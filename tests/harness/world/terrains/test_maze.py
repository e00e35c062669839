import numpy as np
import pytest
from scipy.ndimage import label

from harness.world.obstacles import Obstacle
from harness.world.terrains.maze import CHAMBERS, PITCH
from harness.world.world import build_world

STEP = 0.1  # [m] of the grid that is searched
NARROWEST = 1.2  # [m] passage that a rover needs


def _free(obstacles: tuple[Obstacle, ...], axis: np.ndarray) -> np.ndarray:
    """Where the centre of a disc of the narrowest passage fits, [col, row]."""
    x, y = np.meshgrid(axis, axis, indexing="ij")
    free = np.ones_like(x, dtype=bool)
    for wall in obstacles:
        beyond_x = np.maximum(np.abs(x - wall.position[0]) - wall.half_size[0], 0.0)
        beyond_y = np.maximum(np.abs(y - wall.position[1]) - wall.half_size[1], 0.0)
        free &= np.hypot(beyond_x, beyond_y) > 0.5 * NARROWEST
    return free


@pytest.mark.parametrize("difficulty", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_rover_can_reach_every_chamber_but_not_leave(seed: int, difficulty: float) -> None:
    axis = np.arange(-120, 121) * STEP
    free = _free(build_world("maze", seed, difficulty).obstacles, axis)
    parts, _ = label(free)
    reached = parts == parts[120, 120]
    centres = (np.arange(CHAMBERS) - CHAMBERS // 2) * PITCH
    indices = np.round(centres / STEP).astype(int) + 120
    assert reached[np.ix_(indices, indices)].all()
    assert not reached[:15].any()
    assert not reached[:, -15:].any()
