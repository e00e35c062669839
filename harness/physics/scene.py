"""World + rover -> one compiled MuJoCo model: terrain heightfield, obstacle bodies, truth sensors.

Geom groups say what a thing is: 0 terrain, 1 obstacles, 2 rover as seen, 3 rover as it collides. The
lidar's ray mask and the pictures rely on them.
"""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import mujoco
import numpy as np

from harness.errors import UsageError
from harness.robots import RoverSpec
from harness.world.actors.actor import Actor
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World

TERRAIN_GROUP, OBSTACLE_GROUP, VISUAL_GROUP = 0, 1, 2
GROUND_CONTACT = {"contype": 2, "conaffinity": 1}  # the rover's geoms carry (1, 2)
BASE_THICKNESS = 1.0  # [m] of solid ground below the lowest point

TERRAIN = "terrain"
BODY_PREFIX = "body_"  # of the names of the rover's geoms that are not wheels
ROCK_CONTACT, HAZARD_CONTACT, SCRAPE_CONTACT = "rock_contact", "hazard_contact", "scrape_contact"
OBSTACLE_BODIES = {ObstacleKind.ROCK: "rocks", ObstacleKind.HAZARD: "hazards"}
SHAPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
}

Dress = Callable[[mujoco.MjSpec], None]


@dataclass(frozen=True, eq=False)
class Scene:
    """A compiled model with what it was made from."""

    model: mujoco.MjModel
    world: World
    rover: RoverSpec


def build_scene(world: World, rover: RoverSpec, timestep: float, dress: Dress | None = None) -> Scene:
    """Returns the rover compiled into the world.

    Args:
        world: Ground and obstacles.
        rover: Which rover.
        timestep: Of the physics [s].
        dress: Adds colours and light to what is to be looked at. Without it, the geoms that are only
            to be seen are left out: a step is 5 % faster, and the physics is the same.
    """
    path = rover.model_path
    spec = _without_visuals(path, model_hash(rover)).copy() if dress is None else read_model(path)
    spec.option.timestep = timestep
    _keep_constraints_soft(spec, timestep)
    _add_terrain(spec, world)
    _add_obstacles(spec, world.obstacles)
    _add_actors(spec, world.people)
    _add_truth_sensors(spec, world.people)
    if dress is not None:
        dress(spec)
    return Scene(model=spec.compile(), world=world, rover=rover)


def read_model(path: Path) -> mujoco.MjSpec:
    """Returns a rover's model of that file, not compiled.

    Raises:
        UsageError: The file of one of its meshes is not there.
    """
    spec = mujoco.MjSpec.from_file(str(path))
    for mesh in spec.meshes:
        file = path.parent / spec.meshdir / mesh.file
        if mesh.file and not file.is_file():
            message = f"mesh '{mesh.name}' is to be in {file}, which does not exist"
            raise UsageError(f"{path}: {message}; put it there, or mend its name")
    return spec


def model_hash(rover: RoverSpec) -> str:
    """Returns the SHA-256 of the rover's model file."""
    return hashlib.sha256(rover.model_path.read_bytes()).hexdigest()


@cache
def _without_visuals(path: Path, _: str) -> mujoco.MjSpec:
    """A model file of that content, to be copied: to read it and to drop geoms takes most of a scene."""
    spec = read_model(path)
    for geom in [g for g in spec.geoms if g.group == VISUAL_GROUP]:
        spec.delete(geom)
    return spec


def _keep_constraints_soft(spec: mujoco.MjSpec, timestep: float) -> None:
    # MuJoCo clamps a time constant below two steps and would change the stiffness silently.
    for equality in spec.equalities:
        equality.solref = [max(equality.solref[0], 2 * timestep), equality.solref[1]]


def _add_terrain(spec: mujoco.MjSpec, world: World) -> None:
    heights = world.ground.heights
    lowest = float(heights.min())
    # The compiler normalises to 0..1 and wants a positive range, even for a flat map.
    relief = max(float(np.ptp(heights)), 1e-3)
    spec.add_hfield(
        name="terrain",
        size=[*world.ground.half_size, relief, BASE_THICKNESS],
        nrow=heights.shape[0],
        ncol=heights.shape[1],
        userdata=((heights - lowest) / relief).ravel().tolist(),
    )
    spec.worldbody.add_geom(
        name=TERRAIN,
        type=mujoco.mjtGeom.mjGEOM_HFIELD,
        hfieldname="terrain",
        pos=[0.0, 0.0, lowest],
        group=TERRAIN_GROUP,
        **GROUND_CONTACT,
    )


def _add_obstacles(spec: mujoco.MjSpec, obstacles: tuple[Obstacle, ...]) -> None:
    bodies = {kind: spec.worldbody.add_body(name=name) for kind, name in OBSTACLE_BODIES.items()}
    for index, obstacle in enumerate(obstacles):
        bodies[obstacle.kind].add_geom(
            name=f"{obstacle.kind.name.lower()}_{index}",
            type=SHAPES[obstacle.shape],
            size=[*obstacle.half_size, 0.0][:3],
            pos=list(obstacle.position),
            quat=list(obstacle.quaternion),
            group=OBSTACLE_GROUP,
            **GROUND_CONTACT,
        )


def _add_actors(spec: mujoco.MjSpec, actors: tuple[Actor, ...]) -> None:
    for actor in actors:
        options = actor.spec.options
        x, y = actor.begin
        height = actor.world.ground.height_at(x, y) + 0.5 * options.height
        body = spec.worldbody.add_body(name=actor.name, mocap=True, pos=[x, y, height])
        body.add_geom(
            name=actor.name,
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            size=[options.radius, 0.5 * options.height - options.radius, 0.0],
            group=OBSTACLE_GROUP,
            **(GROUND_CONTACT if options.push else {"contype": 0, "conaffinity": 0}),
        )


def _add_truth_sensors(spec: mujoco.MjSpec, actors: tuple[Actor, ...]) -> None:
    """Contact counts of the whole rover with rocks, hazards and people, of its body with the ground."""
    subtree, body, geom = (mujoco.mjtObj.mjOBJ_XBODY, mujoco.mjtObj.mjOBJ_BODY, mujoco.mjtObj.mjOBJ_GEOM)
    counts = [
        (ROCK_CONTACT, (subtree, "rover"), (body, "rocks")),
        (HAZARD_CONTACT, (subtree, "rover"), (body, "hazards")),
    ]
    solid = (actor.name for actor in actors if actor.spec.options.push)
    counts += [(f"{HAZARD_CONTACT}_{name}", (subtree, "rover"), (body, name)) for name in solid]
    scraping = (part for part in spec.bodies if any(g.name.startswith(BODY_PREFIX) for g in part.geoms))
    counts += [(f"{SCRAPE_CONTACT}_{b.name}", (body, b.name), (geom, TERRAIN)) for b in scraping]
    found, net_force, slots = 1 << int(mujoco.mjtConDataField.mjCONDATA_FOUND), 3, 1
    for name, (kind, one), (other_kind, other) in counts:
        spec.add_sensor(
            name=name,
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=kind,
            objname=one,
            reftype=other_kind,
            refname=other,
            intprm=[found, net_force, slots],
        )
