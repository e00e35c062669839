"""World + rovers -> one compiled MuJoCo model: terrain heightfield, obstacle bodies, truth sensors.

The first rover is the model that the world is added to; others are attached behind it, under a prefix.
So the model of a single rover is as if there could be no others.
"""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import mujoco
import numpy as np

from harness.physics.actuators import fit_motors, resist_rolling, sense_motors
from harness.physics.berths import Member
from harness.physics.world_geoms import (
    OBSTACLE_GROUP,
    TERRAIN,
    UNDERGROUND,
    VISUAL_GROUP,
    add_skins,
    add_world,
    limit_friction,
)
from harness.robots import RoverSpec
from harness.robots.content import model_hash
from harness.robots.model import COLLIDING_GROUP, ROOT_ID, read_model, root_of
from harness.soil.soils import SOIL_CONTACT
from harness.world.world import World

ARENA = 40 << 20  # [B]: beyond the 32 MiB that glibc takes from its heap, where freed ones leave holes
ITERATIONS = 100, 50  # at least, MuJoCo's own: a model for training may stop after one
FIRST_OF_FLEET = 4  # the contact bit of the second rover; the next one has twice that

ROCK_CONTACT, HAZARD_CONTACT, SCRAPE_CONTACT = "rock_contact", "hazard_contact", "scrape_contact"

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


def build_scene(world: World, rover: RoverSpec, timestep: float) -> Scene:
    """Returns the rover compiled into the world.

    Args:
        world: Ground and obstacles.
        rover: Which rover.
        timestep: Of the physics [s].
    """
    (scene,) = build_scenes(world, (Member("", rover, world.start),), timestep)
    return scene


def build_scenes(
    world: World, fleet: Sequence[Member], timestep: float, dress: Dress | None = None
) -> tuple[Scene, ...]:
    """Returns each rover in the model that all are compiled into.

    Args:
        world: Ground and obstacles.
        fleet: The rovers; gravity and MuJoCo's options are those of the first one's model.
        timestep: Of the physics [s].
        dress: Adds colours and light to what is to be looked at. Without it, the geoms that are only
            to be seen are left out: a step is 5 % faster, and the physics is the same.
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
        one.option.iterations = max(one.option.iterations, ITERATIONS[0])
        one.option.ls_iterations = max(one.option.ls_iterations, ITERATIONS[1])
        fit_motors(one, rover)
    spec = specs[0]
    spec.memory = max(spec.memory, ARENA)  # a model may ask for more
    if len(specs) == 1:  # it hangs together: to look for islands takes 2 % of a step
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ISLAND)
    add_world(spec, world)
    with warnings.catch_warnings(action="ignore"):  # of assets by name: ours are files
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
        limit_friction(spec, world.friction)
    if dress is not None:
        add_skins(spec, world)
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


def motors_of(model: mujoco.MjModel, joints: tuple[str, ...]) -> list[int]:
    """Returns the actuator of each joint.

    Raises:
        KeyError: A joint has none.
    """
    moving = np.flatnonzero(model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT).tolist()
    on = {int(model.actuator_trnid[motor, 0]): motor for motor in moving}
    return [on[model.joint(name).id] for name in joints]


def body_geoms(scene: Scene) -> set[int]:
    """Returns what collides of a rover and is no wheel's and no caster's."""
    model = scene.model
    wheels = {int(model.joint(name).bodyid[0]) for name in scene.all_own(scene.rover.wheel_joints)}
    casters = {int(model.body(name).id) for name in scene.all_own(scene.rover.casters)}
    carriers = wheels | casters
    colliding = (geom for geom in scene.geoms() if model.geom_group[geom] == COLLIDING_GROUP)
    bodies = {geom: int(model.geom_bodyid[geom]) for geom in colliding}
    return {g for g, body in bodies.items() if not carriers & {body, int(model.body_weldid[body])}}


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
        if part.name.removeprefix(prefix) not in rover.casters and _scrapes(part, wheels):
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
