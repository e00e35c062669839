"""What the oracle for topics (tests/e2e) does not see of the simulation: letting down, and a reset."""

import mujoco
import pytest

from harness.config import EpisodeConfig
from harness.robots import LEO
from harness.sim_time import NANOSECONDS
from harness.simulation import Simulation
from harness.world.scene import build_scene

TIMESTEP_NS = 5_000_000


def simulation(terrain: str) -> Simulation:
    world = EpisodeConfig(terrain=terrain).world()
    return Simulation(build_scene(world, LEO, TIMESTEP_NS / NANOSECONDS), TIMESTEP_NS)


def test_a_rover_that_creeps_down_a_slope_is_given_five_seconds_to_settle(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    steps, step = [], mujoco.mj_step

    def counted(model: object, data: object) -> None:
        steps.append(data)
        step(model, data)

    monkeypatch.setattr(mujoco, "mj_step", counted)
    creeping = simulation("slope")
    assert len(steps) == 5 * NANOSECONDS // TIMESTEP_NS
    assert abs(creeping.data.qvel).max() > 2e-3
    assert creeping.time_ns == 0


def test_after_a_reset_nothing_is_felt_of_the_tick_before_it() -> None:
    standing = simulation("flat")
    standing.data.qpos[2:7] = 0.3, 0.0, 1.0, 0.0, 0.0  # on its roof
    for _ in range(40):
        standing.tick()
    assert standing.contacts.strongest
    assert standing.tick_sum.any()
    standing.return_to_start()
    assert standing.contacts.strongest == {}
    assert not standing.tick_sum.any()
    assert standing.time_ns == 40 * 10_000_000
