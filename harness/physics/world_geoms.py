"""What a world adds to a MuJoCo model: terrain heightfield, obstacle bodies, people, skins of targets.

Geom groups say what a thing is: 0 terrain, 1 obstacles, 2 rover as seen, 3 rover as it collides. The
lidar's ray mask and the pictures rely on them.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.robots.model import SEEN_GROUP
from harness.soil.soils import SOIL_CONTACT
from harness.world.heightfield import Heightfield, finer
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World

TERRAIN_GROUP, OBSTACLE_GROUP, VISUAL_GROUP = 0, 1, SEEN_GROUP
GROUND_CONTACT = {"contype": 2, "conaffinity": 1}  # the rover's geoms carry (1, 2)
UNPAINTED = (0.5, 0.5, 0.5, 1.0)  # MuJoCo's own: harness.view gives them their kind's colour
UNSEEN_GROUP = 5
UNTOUCHED = {"contype": 0, "conaffinity": 0}
SOIL_ROOM = 0.2  # [m] that soil may sink below the lowest point and rise above the highest
RUT_CELL = 0.025  # [m]: half the width of a small rover's wheel
MOST_RUT_CELLS = 4_000_000  # 32 MB; of larger maps the cells are larger
SKINS = "skins"  # of targets
BASE_THICKNESS = 1.0  # [m] of solid ground below the lowest point
TERRAIN = "terrain"
UNDERGROUND = "ground below soil"  # what is no wheel meets it: as the ground was without ruts
OBSTACLE_BODIES = {ObstacleKind.ROCK: "rocks", ObstacleKind.HAZARD: "hazards"}
SHAPES = {
    "convex": mujoco.mjtGeom.mjGEOM_MESH,
    "surface": mujoco.mjtGeom.mjGEOM_MESH,
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
}


def add_world(spec: mujoco.MjSpec, world: World) -> None:
    """Adds ground, obstacles and people."""
    _add_terrain(spec, world)
    _add_obstacles(spec, world.obstacles)
    _add_actors(spec, world)


def limit_friction(spec: mujoco.MjSpec, limit: float) -> None:
    """Lets no contact with the ground have more friction than the rover's part, nor than a limit."""
    # The lesser of the two, as in Gazebo. MuJoCo takes the larger, unless one has priority.
    for geom in spec.geoms:
        is_ground = geom.contype & (GROUND_CONTACT["contype"] | SOIL_CONTACT)
        geom.friction = [0.0 if is_ground else min(geom.friction[0], limit), *geom.friction[1:]]


def add_skins(spec: mujoco.MjSpec, world: World) -> None:
    """Adds what cameras see on targets; no ray and no contact meets it.

    The hulls below the skin of a mesh are not drawn: they would fill its hollows.
    """
    covered = [body for target in world.targets if target.spec.options.texture for body in target.bodies]
    for index, obstacle in enumerate(world.obstacles):
        if obstacle in covered:
            spec.geom(f"{obstacle.kind.name.lower()}_{index}").rgba[3] = 0.0
    body = spec.worldbody.add_body(name=SKINS)
    for number, skin in enumerate(skin for target in world.targets for skin in target.skins):
        name, (height, width, _) = f"{SKINS}_{number}", skin.image.shape
        texture = spec.add_texture(
            name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, width=width, height=height, nchannel=3
        )
        texture.data = skin.image.tobytes()
        material = spec.add_material(name=name, specular=0.0, reflectance=0.0)
        material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
        spec.add_mesh(
            name=name,
            uservert=skin.vertices.ravel().tolist(),
            userface=skin.faces.ravel().tolist(),
            usertexcoord=skin.picture.ravel().tolist(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=name,
            material=name,
            rgba=[1.0, 1.0, 1.0, 1.0],
            group=OBSTACLE_GROUP,
            **UNTOUCHED,
        )


def heights_of(model: mujoco.MjModel, geom: int) -> NDArray[np.float32]:
    """Returns heights of a geom's heightfield, from 0 to 1: a view, shape (rows, columns)."""
    field = model.geom_dataid[geom]
    shape = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    heights: NDArray[np.float32] = model.hfield_data[model.hfield_adr[field] :][: math.prod(shape)]
    return heights.reshape(shape)


def soil_ground(world: World) -> Heightfield:
    """Returns the ground of a world, in cells fine enough for ruts where its soil leaves some."""
    return _fine(world.ground) if world.soil and world.soil.leaves_ruts else world.ground


@lru_cache(maxsize=2)
def _fine(ground: Heightfield) -> Heightfield:
    """Returns a ground in cells that are fine enough for ruts, or as fine as a large map allows."""
    rows, columns = ground.heights.shape
    area = (rows - 1) * (columns - 1) * ground.cell**2
    cell = max(RUT_CELL, math.sqrt(area / MOST_RUT_CELLS))
    parts = math.ceil(ground.cell / cell - 1e-9)
    return ground if parts <= 1 else finer(ground, parts)


def _add_terrain(spec: mujoco.MjSpec, world: World) -> None:
    if world.soil is None:
        _add_heights(spec, TERRAIN, world.ground, TERRAIN_GROUP, GROUND_CONTACT)
        return
    fine = soil_ground(world)
    heights = fine.heights.copy()
    heights[0, 0], heights[-1, -1] = heights.min() - SOIL_ROOM, heights.max() + SOIL_ROOM
    _add_heights(spec, TERRAIN, replace(fine, heights=heights), TERRAIN_GROUP, UNTOUCHED)
    contact = {"contype": SOIL_CONTACT, "conaffinity": 0}
    _add_heights(spec, UNDERGROUND, world.ground, UNSEEN_GROUP, contact)


def _add_heights(
    spec: mujoco.MjSpec, name: str, ground: Heightfield, group: int, contact: Mapping[str, int]
) -> None:
    lowest = float(ground.heights.min())
    # The compiler normalises to 0..1 and wants a positive range, even for a flat map.
    relief = max(float(np.ptp(ground.heights)), 1e-3)
    # As a file in memory: number by number it takes twice as long to compile.
    shape, cells = np.array(ground.heights.shape, np.int32), (ground.heights - lowest) / relief
    spec.assets = spec.assets | {name: shape.tobytes() + cells.astype(np.float32).tobytes()}
    spec.add_hfield(
        name=name,
        size=[*ground.half_size, relief, BASE_THICKNESS],
        file=name,
        content_type="image/vnd.mujoco.hfield",
    )
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_HFIELD,
        hfieldname=name,
        pos=[*ground.middle, lowest],
        group=group,
        **contact,
    )


def _add_obstacles(spec: mujoco.MjSpec, obstacles: tuple[Obstacle, ...]) -> None:
    bodies = {kind: spec.worldbody.add_body(name=name) for kind, name in OBSTACLE_BODIES.items()}
    bodies[ObstacleKind.DECK] = spec.worldbody  # as the terrain is
    for index, obstacle in enumerate(obstacles):
        name, is_mesh = f"{obstacle.kind.name.lower()}_{index}", bool(obstacle.corners)
        if is_mesh:  # a convex hull, or a surface that need not be closed
            spec.add_mesh(
                name=name,
                uservert=np.ravel(obstacle.corners).tolist(),
                userface=np.ravel(obstacle.faces).astype(int).tolist(),
                inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            )
        bodies[obstacle.kind].add_geom(
            name=name,
            meshname=name if is_mesh else "",
            type=SHAPES[obstacle.shape],
            size=[*obstacle.half_size, 0.0][:3],
            pos=list(obstacle.position),
            quat=list(obstacle.quaternion),
            rgba=UNPAINTED if obstacle.color is None else obstacle.color,
            group=OBSTACLE_GROUP,
            **(UNTOUCHED if obstacle.shape == "surface" else GROUND_CONTACT),
        )


def _add_actors(spec: mujoco.MjSpec, world: World) -> None:
    for actor in world.people:
        options = actor.spec.options
        x, y = actor.begin
        height = world.ground.height_at(x, y) + 0.5 * options.height
        body = spec.worldbody.add_body(name=actor.name, mocap=True, pos=[x, y, height])
        body.add_geom(
            name=actor.name,
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            size=[options.radius, 0.5 * options.height - options.radius, 0.0],
            group=OBSTACLE_GROUP,
            **(GROUND_CONTACT if options.push else UNTOUCHED),
        )
