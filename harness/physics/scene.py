"""World + rovers -> one compiled MuJoCo model: terrain heightfield, obstacle bodies, truth sensors.

The first rover is the model that the world is added to; others are attached behind it, under a prefix.
So the model of a single rover is as if there could be no others.

Geom groups say what a thing is: 0 terrain, 1 obstacles, 2 rover as seen, 3 rover as it collides. The
lidar's ray mask and the pictures rely on them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import mujoco
import numpy as np

from harness.robots import RoverSpec
from harness.robots.model import COLLIDING_GROUP, ROOT_ID, SEEN_GROUP, read_model, root_of
from harness.robots.reading import model_hash
from harness.world.actors.actor import Actor
from harness.world.berths import Member
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World

TERRAIN_GROUP, OBSTACLE_GROUP, VISUAL_GROUP = 0, 1, SEEN_GROUP
GROUND_CONTACT = {"contype": 2, "conaffinity": 1}  # the rover's geoms carry (1, 2)
UNPAINTED = (0.5, 0.5, 0.5, 1.0)  # MuJoCo's own: harness.view gives them their kind's colour
FIRST_OF_FLEET = 4  # the contact bit of the second rover; the next one has twice that
UNTOUCHED = {"contype": 0, "conaffinity": 0}
BASE_THICKNESS = 1.0  # [m] of solid ground below the lowest point

TERRAIN = "terrain"
ROCK_CONTACT, HAZARD_CONTACT, SCRAPE_CONTACT = "rock_contact", "hazard_contact", "scrape_contact"
OBSTACLE_BODIES = {ObstacleKind.ROCK: "rocks", ObstacleKind.HAZARD: "hazards"}
SHAPES = {
    "convex": mujoco.mjtGeom.mjGEOM_MESH,
    "surface": mujoco.mjtGeom.mjGEOM_MESH,
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
}

Dress = Callable[[mujoco.MjSpec], None]


@dataclass(frozen=True, eq=False)
class Scene:
    """A rover in a compiled model, which others may share.

    Attributes:
        model: Of the world and all its rovers.
        world: What they drive in, with the start of this one.
        rover: Which rover.
        name: What it is called among others; empty of a single one.
        prefix: Of the names that its parts have in the model.
        root: Its root body.
    """

    model: mujoco.MjModel
    world: World
    rover: RoverSpec
    name: str = ""
    prefix: str = ""
    root: int = ROOT_ID

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
    parts = [
        {prefix + body.name for body in spec.bodies[1:]}
        for prefix, spec in zip(prefixes, specs, strict=True)
    ]
    for number, one in enumerate(specs):
        _let_meet(one, number, len(specs))
    spec = specs[0]
    spec.option.timestep = timestep
    _add_terrain(spec, world)
    _add_obstacles(spec, world.obstacles)
    _add_actors(spec, world)
    for prefix, other in zip(prefixes[1:], specs[1:], strict=True):
        spec.attach(other, prefix=prefix, frame=spec.worldbody.add_frame())
    _keep_constraints_soft(spec, timestep)
    for prefix, root, own, rover in zip(prefixes, roots, parts, rovers, strict=True):
        others = [other for other in roots if other != root]
        _add_truth_sensors(spec, (prefix, root, own), rover, (world.people, others))
    if world.gravity is not None:
        spec.option.gravity = [0.0, 0.0, -world.gravity]
    if world.friction is not None:
        _limit_friction(spec, world.friction)
    if dress is not None:
        dress(spec)
    model = spec.compile()
    return tuple(
        Scene(model, replace(world, start=of.start), of.rover, of.name, prefix, model.body(root).id)
        for of, prefix, root in zip(fleet, prefixes, roots, strict=True)
    )


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
        pos=[*world.ground.middle, lowest],
        group=TERRAIN_GROUP,
        **GROUND_CONTACT,
    )


def _add_obstacles(spec: mujoco.MjSpec, obstacles: tuple[Obstacle, ...]) -> None:
    bodies = {kind: spec.worldbody.add_body(name=name) for kind, name in OBSTACLE_BODIES.items()}
    bodies[ObstacleKind.DECK] = spec.worldbody  # as the terrain is
    for index, obstacle in enumerate(obstacles):
        name, is_mesh = f"{obstacle.kind.name.lower()}_{index}", bool(obstacle.corners)
        if is_mesh:
            _add_mesh(spec, name, obstacle)
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


def _add_mesh(spec: mujoco.MjSpec, name: str, obstacle: Obstacle) -> None:
    """Adds a convex hull, or a surface that need not be closed."""
    spec.add_mesh(
        name=name,
        uservert=np.ravel(obstacle.corners).tolist(),
        userface=np.ravel(obstacle.faces).astype(int).tolist(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )


def _limit_friction(spec: mujoco.MjSpec, friction: float) -> None:
    """Takes the lesser of two frictions, as Gazebo does: the rover's geoms decide, by their priority."""
    for geom in spec.geoms:
        if not geom.contype & GROUND_CONTACT["contype"]:
            geom.friction = [min(geom.friction[0], friction), *geom.friction[1:]]


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
            **(GROUND_CONTACT if options.push else {"contype": 0, "conaffinity": 0}),
        )


def _add_truth_sensors(
    spec: mujoco.MjSpec,
    whose: tuple[str, str, set[str]],
    rover: RoverSpec,
    moving: tuple[Sequence[Actor], Sequence[str]],
) -> None:
    """Contact counts of a whole rover with rocks and whatever moves, of its body with the ground.

    Args:
        spec: The world with all rovers.
        whose: Prefix, root body and all bodies of the rover.
        rover: Which it is.
        moving: Who else moves: people, and the root bodies of other rovers.
    """
    subtree, body, geom = (mujoco.mjtObj.mjOBJ_XBODY, mujoco.mjtObj.mjOBJ_BODY, mujoco.mjtObj.mjOBJ_GEOM)
    prefix, root, parts = whose
    counts = [
        (ROCK_CONTACT, (subtree, root), (body, "rocks")),
        (HAZARD_CONTACT, (subtree, root), (body, "hazards")),
    ]
    actors, others = moving
    solid = (actor.name for actor in actors if actor.spec.options.push)
    counts += [(f"{HAZARD_CONTACT}_{name}", (subtree, root), (body, name)) for name in solid]
    counts += [(f"{HAZARD_CONTACT}_{name}", (subtree, root), (subtree, name)) for name in others]
    wheels = {prefix + name for name in rover.wheel_joints}
    scraping = (part for part in spec.bodies if part.name in parts and _scrapes(part, wheels))
    has_decks = any(item.group == OBSTACLE_GROUP for item in spec.worldbody.geoms)
    ground = (body, "world") if has_decks else (geom, TERRAIN)
    counts += [
        (f"{SCRAPE_CONTACT}_{b.name.removeprefix(prefix)}", (body, b.name), ground) for b in scraping
    ]
    count, net_force, slots = 1 << int(mujoco.mjtConDataField.mjCONDATA_FOUND), 3, 1
    for name, (kind, one), (other_kind, other) in counts:
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
    while not body.joints and body.parent.name != "world":
        body = body.parent
    return not any(joint.name in wheels for joint in body.joints)
