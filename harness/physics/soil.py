"""Soil in a scene: a finer ground that sinks and rises, wheels that meet it by the soil's forces."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from harness.base.errors import UsageError
from harness.physics.scene import Scene
from harness.physics.world_geoms import TERRAIN, heights_of, soil_ground
from harness.robots.model import COLLIDING_GROUP, reach

if TYPE_CHECKING:
    from harness.soil.bed import Bed
    from harness.soil.wheel_force import SoilWheel

ROUND = 0.9  # least over largest reach of a wheel's rim from its axle: an octagon has 0.92


def soil_bed(scenes: Sequence[Scene], data: mujoco.MjData) -> "Bed | None":
    """Returns the soil under all rovers of a model; None on rigid ground.

    Raises:
        UsageError: A wheel is too narrow for ruts, or the soil too stiff for the timestep.
    """
    world, model = scenes[0].world, scenes[0].model
    if world.soil is None:
        return None
    from harness.soil.bed import Bed, Ground  # noqa: PLC0415 - with kernels that only soil needs

    geom, ground = model.geom(TERRAIN).id, soil_ground(world)
    field = heights_of(model, geom)
    relief, base = float(model.hfield_size[model.geom_dataid[geom], 2]), float(model.geom_pos[geom, 2])
    field[:] = (ground.heights - base) / relief  # the corners had to hold the extremes
    (half_x, half_y), (x, y) = ground.half_size, ground.middle
    corner = x - half_x, y - half_y
    solid = scenes[0].world.ground
    numbers = Ground(
        heights=ground.heights,
        corner=corner,
        cell=ground.cell,
        field=field,
        base=base,
        relief=relief,
        solid=solid.heights,
        solid_cell=solid.cell,
        patches=world.soil.patches,
    )
    wheels = [wheel for scene in scenes for wheel in _wheels(scene, data)]
    for wheel in wheels:
        if wheel.width < ground.cell and world.soil.leaves_ruts:
            raise UsageError(
                f"wheels {1e3 * wheel.width:.0f} mm wide are too narrow for soil, whose ruts have "
                f"cells of {1e3 * ground.cell:g} mm; leave out --soil"
            )
    return Bed(world.soil.kinds, numbers, wheels, model, data)


def _roundness(model: mujoco.MjModel, data: mujoco.MjData, joint: int) -> float:
    """How far the geoms of a wheel that collide reach from its axle, at least as a share of at most."""
    geoms = model.body_weldid[model.geom_bodyid] == model.body_weldid[model.jnt_bodyid[joint]]
    across = np.linalg.svd(data.xaxis[joint][None])[2][1:]  # two directions off the axle
    angles = np.linspace(0.0, 2.0 * np.pi, 48)
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ across
    farthest = np.zeros(len(angles))
    for geom in np.flatnonzero(geoms & (model.geom_group == COLLIDING_GROUP)).tolist():
        hub = data.geom_xpos[geom] - data.xanchor[joint]
        own = reach(model, geom, rays @ data.geom_xmat[geom].reshape(3, 3))
        farthest = np.maximum(farthest, rays @ hub + own)
    return float(farthest.min() / farthest.max())


def _wheels(scene: Scene, data: mujoco.MjData) -> list["SoilWheel"]:
    model, rover = scene.model, scene.rover
    mujoco.mj_kinematics(model, data)
    mass = model.body_subtreemass[scene.root]
    load = float(mass) * -float(model.opt.gravity[2]) / len(rover.wheel_joints)
    left = data.xmat[scene.root].reshape(3, 3)[:, 1]
    from harness.soil.wheel_force import SoilWheel  # noqa: PLC0415 - see `soil_bed`

    made = []
    for name in scene.all_own(rover.wheel_joints):
        joint = model.joint(name)
        to_left = bool(data.xaxis[joint.id] @ left > 0.0)
        if _roundness(model, data, joint.id) < ROUND:
            raise UsageError(f"wheel '{name}' is not round, which it must be on soil; leave out --soil")
        size = rover.wheel_radius, rover.wheel_width, rover.grousers
        made.append(SoilWheel(int(joint.bodyid[0]), joint.id, scene.root, *size, to_left, load))
    return made
