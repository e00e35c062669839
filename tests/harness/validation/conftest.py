"""The suite driven once for both rovers; several tests look at it."""

from functools import partial

import pytest

from harness.robots import ROVERS
from harness.validation.check import Check
from harness.validation.suite import validate
from tests.support.once import made_once


@pytest.fixture(scope="session")
def driven(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Check]]:
    """The checks of each rover with seed 0, by its name."""
    return {
        name: made_once(tmp_path_factory, f"validated_{name}", partial(validate, rover, seed=0))
        for name, rover in ROVERS.items()
    }
