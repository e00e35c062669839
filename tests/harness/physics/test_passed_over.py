"""Obstacles out of reach are passed over; all bits are still those of MuJoCo's own steps."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from harness.base.errors import RunFailed
from harness.physics.berths import Member
from harness.physics.passed_over import obstacles_of, pass_over, restore
from harness.physics.scene import build_scenes
from harness.physics.simulation import Simulation, simulations
from harness.robots import ROVERS
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World
from tests.harness.conftest import TIMESTEP_NS
from tests.support.kernels import compiled

BITS = "geom_contype", "geom_conaffinity", "body_contype", "body_conaffinity"


def strewn(rng: np.random.Generator) -> tuple[Obstacle, ...]:
    """Obstacles of every kind and shape about a map of 12 m, some of them where the rovers stand."""
    shapes = [("ellipsoid", ObstacleKind.ROCK), ("box", ObstacleKind.HAZARD), ("box", ObstacleKind.DECK)]
    shapes.append(("cylinder", ObstacleKind.HAZARD))
    picked = (shapes[index] for index in rng.integers(len(shapes), size=150))
    return tuple(
        Obstacle(kind, shape, tuple(rng.uniform(0.02, 0.3, 3)), (*rng.uniform(-5.5, 5.5, 2), -0.05))
        for shape, kind in picked
    )


def rovers(rng: np.random.Generator, robots: tuple[str, ...]) -> tuple[Simulation, ...]:
    ground = Heightfield(rng.normal(0.0, 0.02, (61, 61)), 0.2)
    world = World("strewn", ground, strewn(rng), seed=0, difficulty=0.0)
    starts = ((0.0, 0.0, 0.3), (1.5, 1.5, 2.0))
    fleet = [Member(name, ROVERS[name], start) for name, start in zip(robots, starts, strict=False)]
    fleet[0] = replace(fleet[0], name="")
    return simulations(build_scenes(world, fleet, TIMESTEP_NS / 1e9), TIMESTEP_NS)


@pytest.mark.parametrize("robots", [("leo",), ("rover_zero4wd", "husky")])
@pytest.mark.parametrize("seed", range(4))
def test_rovers_thrown_among_obstacles_go_where_single_steps_of_mujoco_take_them(
    robots: tuple[str, ...], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    going = rovers(rng, robots)
    physics, model = going[0].physics, going[0].model
    alone, touched, missed = mujoco.MjData(model), 0, 0
    obstacles = obstacles_of([each.scene for each in going], physics.data)
    for each in going:  # fast, and spinning
        each.twist[:] = [*rng.uniform(-6.0, 6.0, 2), 1.5, *rng.uniform(-9.0, 9.0, 3)]
    mujoco.mj_copyData(alone, model, physics.data)
    whole = [getattr(model, name).copy() for name in BITS]
    for _ in range(20):
        for each in going:
            each.command_ahead(np.full((5, 4), rng.uniform(-5.0, 5.0)))
        compiled(pass_over)(obstacles, physics.data.qpos, physics.data.qvel)
        missed += int(np.count_nonzero(whole[0] & ~model.geom_contype))
        compiled(restore)(obstacles)
        physics.run()
        try:
            for _ in physics.shown():
                pass
        except RunFailed:
            break
        for each in going:
            alone.ctrl[each.motors] = physics.data.ctrl[each.motors]
        for _ in range(5 * physics.steps_per_tick):
            mujoco.mj_step(model, alone)
            touched += int(np.isin(alone.contact.geom, obstacles[1][:, 0]).sum())
        assert physics.data.qpos.tolist() == alone.qpos.tolist()
        assert physics.data.qvel.tolist() == alone.qvel.tolist()
        for name, bits in zip(BITS, whole, strict=True):
            assert getattr(model, name).tolist() == bits.tolist()
    assert missed
    assert touched
