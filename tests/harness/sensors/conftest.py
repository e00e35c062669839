"""Two rovers beside each other, for what must not take the one for the other."""

import numpy as np
import pytest

from harness.physics.scene import build_scenes
from harness.physics.simulation import Simulation, simulations
from harness.world.berths import Member
from harness.world.heightfield import Heightfield
from harness.world.world import World
from tests.support.rovers import LEO, ROVER_ZERO4WD


@pytest.fixture(scope="session")
def two_rovers() -> tuple[Simulation, Simulation]:
    """On flat ground; the second, turned by 0.4 rad, stands 0.7 m ahead of the first."""
    world = World("bench", Heightfield(np.zeros((61, 61)), 0.1), (), seed=0, difficulty=0.0)
    fleet = (Member("a", LEO, (0.0, 0.0, 0.0)), Member("b", ROVER_ZERO4WD, (0.7, 0.0, 0.4)))
    one, other = simulations(build_scenes(world, fleet, 0.0025), 2_500_000)
    return one, other
