"""What tests of several modules of the harness drive on."""

from pathlib import Path

import numpy as np
import pytest


@pytest.fixture
def small_map(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The words for level ground whose edge is 5 m from the start, a quarter of the way on others."""
    path: Path = tmp_path_factory.mktemp("map") / "level.npy"
    np.save(path, np.zeros((33, 33)))
    return ["--terrain", str(path), "--terrain-size", "10"]
