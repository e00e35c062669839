"""MuJoCo as the oracle: worlds compiled on their own, without a rover."""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from harness.world.world import World

SHAPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
}
PROBE_RADIUS, SKY = 0.01, 100.0  # [m]

TopAt = Callable[[float, float], float]


def _compile(world: World, *, ground: bool) -> tuple[mujoco.MjModel, mujoco.MjData]:
    spec = mujoco.MjSpec()
    if ground:
        heights = world.ground.heights
        lowest, relief = float(heights.min()), max(float(np.ptp(heights)), 1e-3)
        spec.add_hfield(
            name="terrain",
            size=[*world.ground.half_size, relief, 1.0],
            nrow=heights.shape[0],
            ncol=heights.shape[1],
            userdata=((heights - lowest) / relief).ravel().tolist(),
        )
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_HFIELD, hfieldname="terrain", pos=[0.0, 0.0, lowest]
        )
    else:
        spec.worldbody.add_geom(  # a needle at the spawn
            type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[PROBE_RADIUS, 20.0, 0.0]
        )
        for obstacle in world.obstacles:
            spec.worldbody.add_geom(
                type=SHAPES[obstacle.shape],
                size=[*obstacle.half_size, 0.0][:3],
                pos=list(obstacle.position),
                quat=list(obstacle.quaternion),
            )
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


def _rays_from_above(world: World, *, ground: bool) -> TopAt:
    model, data = _compile(world, ground=ground)

    def top_at(x: float, y: float) -> float:
        down, hit = np.array([0.0, 0.0, -1.0]), np.zeros(1, dtype=np.int32)
        distance = mujoco.mj_ray(model, data, np.array([x, y, SKY]), down, None, 1, -1, hit)
        return SKY - distance if distance >= 0.0 else float("nan")

    return top_at


@pytest.fixture
def ground_top() -> Callable[[World], TopAt]:
    """Height [m] of the compiled heightfield at a point, by a vertical ray."""
    return lambda world: _rays_from_above(world, ground=True)


@pytest.fixture
def obstacle_top() -> Callable[[World], TopAt]:
    """Height [m] of the obstacles at a point, by a vertical ray; NaN where none stands."""
    return lambda world: _rays_from_above(world, ground=False)


@pytest.fixture
def spawn_distances() -> Callable[[World], list[float]]:
    """Distance [m] of each obstacle from the vertical through the origin."""

    def measure(world: World) -> list[float]:
        model, data = _compile(world, ground=False)
        return [
            mujoco.mj_geomDistance(model, data, 0, geom, 50.0, None) + PROBE_RADIUS
            for geom in range(1, model.ngeom)
        ]

    return measure
