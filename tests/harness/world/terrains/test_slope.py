import numpy as np
import pytest

from harness.world.world import build_world


@pytest.mark.parametrize(("difficulty", "incline"), [(0.0, 2.0), (0.5, 10.0), (1.0, 22.0)])
def test_it_rises_along_x_at_its_incline_from_edge_to_edge(difficulty: float, incline: float) -> None:
    ground = build_world("slope", 0, difficulty).ground
    rise = ground.height_at(20.0, 0.0) - ground.height_at(-20.0, 0.0)
    assert np.degrees(np.arctan2(rise, 40.0)) == pytest.approx(incline, abs=0.03)
    assert ground.height_at(0.0, 20.0) == pytest.approx(ground.height_at(0.0, -20.0), abs=0.02)
