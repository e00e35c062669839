import numpy as np
import pytest

from harness.world.world import build_world


@pytest.mark.parametrize(("difficulty", "roughness"), [(0.0, 0.003), (0.5, 0.010), (1.0, 0.020)])
def test_neighbouring_cells_differ_independently_by_its_roughness(
    difficulty: float, roughness: float
) -> None:
    steps = np.diff(build_world("gravel", 0, difficulty).ground.heights[:200], axis=1)
    assert steps.std() / np.sqrt(2.0) == pytest.approx(roughness, rel=0.05)


def test_its_cells_are_five_centimetres() -> None:
    assert build_world("gravel", 0).ground.cell == 0.05
