import mujoco
import numpy as np
import pytest

from harness.base.errors import Diverged, RunFailed
from harness.physics.leap import Leap
from harness.physics.scene import HAZARD_CONTACT
from harness.physics.simulation import Simulation
from harness.robots import ROVERS
from harness.world.obstacles import Obstacle, ObstacleKind
from tests.harness.conftest import MakeSimulation

WHOLE = int(mujoco.mjtState.mjSTATE_INTEGRATION)
POST = Obstacle(ObstacleKind.HAZARD, "box", (0.1, 0.4, 0.5), (0.42, 0.0, 0.5))
# [rad/s] of left and right wheels, tick by tick: it stands, sets off, turns, is parked within a leap.
SPEEDS = np.array(
    [(0, 0)] * 5 + [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)] + [(6, 6)] * 50 + [(4, -4)] * 8
)
SPEEDS = np.vstack([SPEEDS, [(0, 0)] * 7])[:, [0, 0, 1, 1]].astype(float)


def state(simulation: Simulation) -> list[float]:
    whole = np.empty(mujoco.mj_stateSize(simulation.model, WHOLE))
    mujoco.mj_getState(simulation.model, simulation.data, whole, WHOLE)
    return [*whole.tolist(), *simulation.tick_sum.tolist(), simulation.time_ns]


@pytest.mark.parametrize("robot", ROVERS)
def test_a_leap_gives_the_bits_that_single_ticks_give(
    make_simulation: MakeSimulation, robot: str
) -> None:
    heights = np.random.default_rng(1).normal(0.0, 0.01, (41, 41))
    stepped, leaping = (make_simulation(robot, heights=heights, obstacles=(POST,)) for _ in range(2))
    leap, hazard, touched = Leap(leaping, 5), leaping.summed(HAZARD_CONTACT), 0
    for period in SPEEDS.reshape(-1, 5, 4):
        leap.take(period)
        leap.run()
        for tick in leap.ticks():
            stepped.command_wheels(period[tick])
            stepped.tick()
            assert leaping.time_ns == stepped.time_ns
            assert leaping.tick_sum.tolist() == stepped.tick_sum.tolist()
            assert leaping.data.qpos.tolist() == stepped.data.qpos.tolist()
            assert leaping.data.qvel.tolist() == stepped.data.qvel.tolist()
            touched += bool(hazard[0])
            assert bool(hazard[0]) == ("hazard" in stepped.contacts.strongest)
        assert state(leaping) == state(stepped)
    assert touched  # or the test would say nothing about contacts


def test_a_leap_off_the_map_or_into_nonsense_is_told(make_simulation: MakeSimulation) -> None:
    simulation = make_simulation()
    leap, still = Leap(simulation, 5), np.zeros((5, 4))
    simulation.data.qpos[0] = 1.6
    leap.take(still)
    leap.run()
    with pytest.raises(RunFailed, match=r"edge of the map at t = 0\.05 s"):
        list(leap.ticks())
    simulation.data.qvel[0] = np.inf
    leap.take(still)
    leap.run()
    with pytest.raises(Diverged):
        list(leap.ticks())
