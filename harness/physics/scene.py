"""World + rovers -> one compiled MuJoCo model: terrain heightfield, obstacle bodies, truth sensors.

The first rover is the model that the world is added to; others are attached behind it, under a prefix.
So the model of a single rover is as if there could be no others.

Geom groups say what a thing is: 0 terrain, 1 obstacles, 2 rover as seen, 3 rover as it collides. The
lidar's ray mask and the pictures rely on them.
"""

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import mujoco
import numpy as np

from harness.physics.actuators import fit_motors, resist_rolling, sense_motors
from harness.robots import RoverSpec
from harness.robots.model import COLLIDING_GROUP, ROOT_ID, SEEN_GROUP, read_model, root_of
from harness.robots.reading import model_hash
from harness.soil.soils import SOIL_CONTACT
from harness.world.berths import Member
from harness.world.heightfield import Heightfield, finer
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World

TERRAIN_GROUP, OBSTACLE_GROUP, VISUAL_GROUP = 0, 1, SEEN_GROUP
GROUND_CONTACT = {"contype": 2, "conaffinity": 1}  # the rover's geoms carry (1, 2)
UNPAINTED = (0.5, 0.5, 0.5, 1.0)  # MuJoCo's own: harness.view gives them their kind's colour
FIRST_OF_FLEET = 4  # the contact bit of the second rover; the next one has twice that
UNSEEN_GROUP = 5
UNTOUCHED = {"contype": 0, "conaffinity": 0}
SOIL_ROOM = 0.2  # [m] that soil may sink below the lowest point and rise above the highest
RUT_CELL = 0.025  # [m]: half the width of a small rover's wheel
MOST_RUT_CELLS = 4_000_000  # 32 MB; of larger maps the cells are larger
SKINS = "skins"  # of targets
BASE_THICKNESS = 1.0  # [m] of solid ground below the lowest point

TERRAIN = "terrain"
UNDERGROUND = "ground below soil"  # what is no wheel meets it: as the ground was without ruts
ROCK_CONTACT, HAZARD_CONTACT, SCRAPE_CONTACT = "rock_contact", "hazard_contact", "scrape_contact"
OBSTACLE_BODIES = {ObstacleKind.ROCK: "rocks", ObstacleKind.HAZARD: "hazards"}
SHAPES = {
    "convex": mujoco.mjtGeom.mjGEOM_MESH,
    "surface": mujoco.mjtGeom.mjGEOM_MESH,
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
}

SUBTREE, BODY = mujoco.mjtObj.mjOBJ_XBODY, mujoco.mjtObj.mjOBJ_BODY

Dress = Callable[[mujoco.MjSpec], None]


@dataclass(frozen=True, eq=False)
class Scene:
    """A rover in a compiled model, which others may share."""

    model: mujoco.MjModel  # of the world and all its rovers
    world: World  # what they drive in, with the start of this one
    rover: RoverSpec
    name: str = ""  # among others; empty of a single one
    prefix: str = ""  # of the names that its parts have in the model
    root: int = ROOT_ID  # its root body

    @property
    def qpos_at(self) -> int:
        """Where the pose of its root stands in MuJoCo's positions."""
        return int(self.model.jnt_qposadr[self.model.body_jntadr[self.root]])

    @property
    def label(self) -> str:
        """What it is called in a sentence."""
        return self.name or "the rover"

    def own(self, name: str) -> str:
        """Returns the name in the model of a part that the rover's own model calls so."""
        return self.prefix + name

    def all_own(self, names: Sequence[str]) -> tuple[str, ...]:
        """Returns the names in the model of some parts."""
        return tuple(map(self.own, names))

    def sensors(self) -> dict[str, slice]:
        """Returns where the values of the rover's sensors stand among MuJoCo's, by its own names."""
        sensors = (self.model.sensor(index) for index in range(self.model.nsensor))
        own = {s.name.removeprefix(self.prefix): s for s in sensors if s.name.startswith(self.prefix)}
        return {
            name: slice(int(s.adr[0]), int(s.adr[0] + s.dim[0]))
            for name, s in own.items()
            if not name.startswith("/")  # another rover's
        }

    def geoms(self) -> list[int]:
        """Returns all geoms of the rover."""
        return np.flatnonzero(self.model.body_rootid[self.model.geom_bodyid] == self.root).tolist()

    def others(self) -> list[int]:
        """Returns what collides of the other rovers."""
        colliding = np.flatnonzero(self.model.geom_group == COLLIDING_GROUP).tolist()
        return sorted(set(colliding) - set(self.geoms()))


def build_scene(world: World, rover: RoverSpec, timestep: float, dress: Dress | None = None) -> Scene:
    """Returns the rover compiled into the world.

    Args:
        world: Ground and obstacles.
        rover: Which rover.
        timestep: Of the physics [s].
        dress: Adds colours and light to what is to be looked at. Without it, the geoms that are only
            to be seen are left out: a step is 5 % faster, and the physics is the same.
    """
    (scene,) = build_scenes(world, (Member("", rover, world.start),), timestep, dress)
    return scene


def build_scenes(
    world: World, fleet: Sequence[Member], timestep: float, dress: Dress | None = None
) -> tuple[Scene, ...]:
    """Returns each rover in the model that all are compiled into.

    Args:
        world: Ground and obstacles.
        fleet: The rovers; gravity and MuJoCo's options are those of the first one's model.
        timestep: Of the physics [s].
        dress: Adds colours and light; None leaves out what is only seen.
    """
    rovers = [member.rover for member in fleet]
    specs = [
        _without_visuals(rover, model_hash(rover)).copy() if dress is None else read_model(rover)
        for rover in rovers
    ]
    prefixes = ["", *(f"/{member.name}/" for member in fleet[1:])]
    roots = [prefix + root_of(spec) for prefix, spec in zip(prefixes, specs, strict=True)]
    for number, (one, rover) in enumerate(zip(specs, rovers, strict=True)):
        _let_meet(one, number, len(specs))
        if world.soil is not None:
            _let_sink(one, rover)
        one.option.timestep = timestep
        fit_motors(one, rover)
    spec = specs[0]
    if len(specs) == 1:  # it hangs together: to look for islands takes 2 % of a step
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ISLAND)
    _add_terrain(spec, world)
    _add_obstacles(spec, world.obstacles)
    _add_actors(spec, world)
    for prefix, other in zip(prefixes[1:], specs[1:], strict=True):
        spec.attach(other, prefix=prefix, frame=spec.worldbody.add_frame())
    _keep_constraints_soft(spec, timestep)
    solid = [(BODY, actor.name) for actor in world.people if actor.spec.options.push]
    for prefix, root, rover in zip(prefixes, roots, rovers, strict=True):
        moving = [*solid, *((SUBTREE, other) for other in roots if other != root)]
        _add_truth_sensors(spec, prefix, root, rover, moving)
        sense_motors(spec, rover, prefix)
    if world.gravity is not None:
        spec.option.gravity = [0.0, 0.0, -world.gravity]
    if world.friction is not None:
        _limit_friction(spec, world.friction)
    if dress is not None:
        _add_skins(spec, world)
        dress(spec)
    else:  # what stands still is not put in its place again in each step
        spec.option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    with warnings.catch_warnings(action="ignore"):  # of options of the other rovers' models
        model = spec.compile()
    model.tree_sleep_policy[:] = int(mujoco.mjtSleepPolicy.mjSLEEP_NEVER)
    for rover, prefix, root in zip(rovers, prefixes, roots, strict=True):
        resist_rolling(model, rover, prefix, model.body(root).id)
    return tuple(
        Scene(model, replace(world, start=of.start), of.rover, of.name, prefix, model.body(root).id)
        for of, prefix, root in zip(fleet, prefixes, roots, strict=True)
    )


def _limit_friction(spec: mujoco.MjSpec, limit: float) -> None:
    # The lesser of the two, as in Gazebo. MuJoCo takes the larger, unless one has priority.
    for geom in spec.geoms:
        is_ground = geom.contype & (GROUND_CONTACT["contype"] | SOIL_CONTACT)
        geom.friction = [0.0 if is_ground else min(geom.friction[0], limit), *geom.friction[1:]]


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


def motors_of(model: mujoco.MjModel, joints: tuple[str, ...]) -> list[int]:
    """Returns the actuator of each joint.

    Raises:
        KeyError: A joint has none.
    """
    on = {int(model.actuator_trnid[motor, 0]): motor for motor in range(model.nu)}
    return [on[model.joint(name).id] for name in joints]


def body_geoms(scene: Scene) -> set[int]:
    """Returns what collides of a rover and is no wheel's."""
    model = scene.model
    wheels = {int(model.joint(name).bodyid[0]) for name in scene.all_own(scene.rover.wheel_joints)}
    colliding = (geom for geom in scene.geoms() if model.geom_group[geom] == COLLIDING_GROUP)
    return {geom for geom in colliding if model.body_weldid[model.geom_bodyid[geom]] not in wheels}


@lru_cache(maxsize=8)
def _without_visuals(rover: RoverSpec, _: str) -> mujoco.MjSpec:
    """A rover's model of that content, to be copied: to read it and drop geoms takes most of a scene."""
    spec = read_model(rover)
    for geom in [g for g in spec.geoms if g.group == VISUAL_GROUP]:
        spec.delete(geom)
    return spec


def _let_meet(spec: mujoco.MjSpec, number: int, count: int) -> None:
    """Lets what collides of a rover meet that of all others, and none of its own parts."""
    bits = [0, *(FIRST_OF_FLEET << other for other in range(count - 1))]
    for geom in spec.geoms:
        if geom.group == COLLIDING_GROUP:
            geom.contype |= sum(bits[number + 1 :])
            geom.conaffinity |= bits[number]


def _let_sink(spec: mujoco.MjSpec, rover: RoverSpec) -> None:
    """Lets soil meet what is no wheel by contacts; wheels meet it by its forces."""
    wheels = set(rover.wheel_joints)
    for body in spec.bodies:
        if body.name != "world" and not any(joint.name in wheels for joint in _joints_of(body)):
            for geom in body.geoms:
                if geom.group == COLLIDING_GROUP:
                    geom.conaffinity |= SOIL_CONTACT


def _joints_of(body: mujoco.MjsBody) -> Sequence[mujoco.MjsJoint]:
    """The joints on which a body turns, those of the body that it is fixed to."""
    while not body.joints and body.parent.name != "world":
        body = body.parent
    joints: Sequence[mujoco.MjsJoint] = body.joints
    return joints


def _keep_constraints_soft(spec: mujoco.MjSpec, timestep: float) -> None:
    # MuJoCo clamps a time constant below two steps and would change the stiffness silently.
    for equality in spec.equalities:
        equality.solref = [max(equality.solref[0], 2 * timestep), equality.solref[1]]


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
    spec.add_hfield(
        name=name,
        size=[*ground.half_size, relief, BASE_THICKNESS],
        nrow=ground.heights.shape[0],
        ncol=ground.heights.shape[1],
        userdata=((ground.heights - lowest) / relief).ravel().tolist(),
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


def _add_skins(spec: mujoco.MjSpec, world: World) -> None:
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


def _add_truth_sensors(
    spec: mujoco.MjSpec, prefix: str, root: str, rover: RoverSpec, moving: Sequence[tuple[int, str]]
) -> None:
    """Counts contacts of a whole rover with rocks and whatever moves, of its body with the ground."""
    whole = SUBTREE, root
    counts = {ROCK_CONTACT: (whole, (BODY, "rocks")), HAZARD_CONTACT: (whole, (BODY, "hazards"))}
    counts |= {f"{HAZARD_CONTACT}_{name}": (whole, (kind, name)) for kind, name in moving}
    wheels = {prefix + name for name in rover.wheel_joints}
    has_decks = any(item.group == OBSTACLE_GROUP for item in spec.worldbody.geoms)
    touched = UNDERGROUND if spec.geom(UNDERGROUND) else TERRAIN
    ground = (BODY, "world") if has_decks else (mujoco.mjtObj.mjOBJ_GEOM, touched)
    for part in (spec.body(root), *spec.body(root).find_all(BODY)):
        if _scrapes(part, wheels):
            counts[f"{SCRAPE_CONTACT}_{part.name.removeprefix(prefix)}"] = (BODY, part.name), ground
    count, net_force, slots = 1 << int(mujoco.mjtConDataField.mjCONDATA_FOUND), 3, 1
    for name, ((kind, one), (other_kind, other)) in counts.items():
        spec.add_sensor(
            name=prefix + name,
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=kind,
            objname=one,
            reftype=other_kind,
            refname=other,
            intprm=[count, net_force, slots],
        )


def _scrapes(body: mujoco.MjsBody, wheels: set[str]) -> bool:
    """Whether something of a body collides that is not on one of the wheels' joints."""
    if not any(geom.group == COLLIDING_GROUP for geom in body.geoms):
        return False
    return not any(joint.name in wheels for joint in _joints_of(body))
