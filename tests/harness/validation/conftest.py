"""The suite driven once for both rovers; several tests look at it."""

import pytest

from harness.robots import ROVERS
from harness.validation.check import Check
from harness.validation.suite import validate


@pytest.fixture(scope="session")
def driven() -> dict[str, list[Check]]:
    """The checks of each rover with seed 0, by its name."""
    return {name: validate(rover, seed=0) for name, rover in ROVERS.items()}
