"""A rover's model as MuJoCo reads it, made to fit the scenes that it is put into.

Models from elsewhere need not follow the conventions of models/. What follows from the model is set
here: a free joint, the groups and the contact bits of geoms, sites and sensors of lidar and IMU, shapes
to be seen where there are none. To the models that ship it changes nothing.
"""

import math
import warnings
from collections.abc import Mapping
from copy import copy
from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np

from harness.base.errors import UsageError
from harness.robots.content import model_hash
from harness.robots.sections import Mount, Tyres
from harness.robots.spec import RoverSpec
from harness.robots.strangers import check_files, check_quantities, inside

SEEN_GROUP, COLLIDING_GROUP, UNSEEN_GROUP = 2, 3, 4
COLLIDING = (1, 2)  # contype, conaffinity; the world has 2 and 1, so that no part touches another
ROOT, ROOT_JOINT = "rover", "root"  # where a model has no names for them
ROOT_ID = 1  # the root body's in every scene: what else there is comes after the rover
SENSORS = {
    "imu_accelerometer": mujoco.mjtSensor.mjSENS_ACCELEROMETER,
    "imu_gyro": mujoco.mjtSensor.mjSENS_GYRO,
}
# Of what harness.physics.scene adds.
TAKEN = frozenset(("terrain", "rocks", "hazards", "rock_contact", "hazard_contact"))
ROUND = (mujoco.mjtGeom.mjGEOM_ELLIPSOID, mujoco.mjtGeom.mjGEOM_CYLINDER)  # radius first
STIFFEST = 5.0  # of a servo: gain x step / inertia that it turns; Leo's are 4.8 (models/README.md)
ABOVE = 0.05  # [m] over the highest point: a lidar that nobody has placed


def read_model(rover: RoverSpec) -> mujoco.MjSpec:
    """Returns a rover's model, not compiled; UsageError if it is unreadable or no rover's."""
    path = inside(rover.model_path, rover.folder, f"{rover.folder / 'rover.yaml'}: key 'model'")
    if not path.is_file():
        raise UsageError(f"{path}, the rover's model, does not exist; put it there, or mend key 'model'")
    check_files(path, rover.folder)
    keep_mujoco_quiet()
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except (OSError, ValueError, mujoco.FatalError) as error:
        raise UsageError(
            f"{path} is no model that MuJoCo reads: {' '.join(str(error).split())}"
        ) from error
    for mesh in spec.meshes:
        file = path.parent / spec.meshdir / mesh.file
        if mesh.file and not file.is_file():
            message = f"mesh '{mesh.name}' is to be in {file}, which does not exist"
            raise UsageError(f"{path}: {message}; put it there, or mend its name")
    _check_names(spec, path)
    free_root(spec, path)
    sort_geoms(spec)
    show_what_collides(spec)
    _put_on(rover, spec)
    has_imu = any(site.name == "imu" for site in spec.sites)
    _add_site(spec, "imu", rover.imu or (None if has_imu else Mount()), path)
    _add_site(spec, "lidar", rover.lidar, path)
    for name, kind in SENSORS.items():
        there = [sensor.type for sensor in spec.sensors if sensor.name == name]
        if there not in ([], [kind]):
            raise UsageError(f"{path}: sensor '{name}' is of another kind; take it out, or rename it")
        if not there:
            spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="imu")
    return spec


def keep_mujoco_quiet() -> None:
    """Lets MuJoCo print no warning, nor write it into MUJOCO_LOG.TXT of the present folder.

    What it warns of is checked where it can happen.
    """
    mujoco.set_mju_user_warning(lambda _: None)


def compiled(spec: mujoco.MjSpec, path: Path) -> mujoco.MjModel:
    """Returns a model, compiled alone; UsageError if MuJoCo does not take it or no rover can be so."""
    try:
        with warnings.catch_warnings(action="ignore"):  # of what check_quantities says better
            model = spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        reason = " ".join(str(error).removeprefix("Error: ").split())
        mend = "; give its body an <inertial> with a mass above 0" if "mjMINVAL" in reason else ""
        raise UsageError(f"{path} is no valid model: {reason}{mend}") from error
    check_quantities(model, path)
    return model


def root_of(spec: mujoco.MjSpec) -> str:
    """Returns the name of the rover's root body."""
    return str(spec.worldbody.first_body().name)


def free_root(spec: mujoco.MjSpec, path: Path) -> None:
    """Leaves one body in the world, which moves freely; UsageError if there is not just one."""
    world = spec.worldbody
    for thing in [*world.geoms, *world.sites, *world.lights, *world.cameras]:  # a floor, a lamp
        spec.delete(thing)
    bodies = list(world.bodies)
    if len(bodies) != 1:
        names = ", ".join(body.name or "one without a name" for body in bodies) or "none"
        raise UsageError(f"{path}: the world must hold the rover's root body alone; it holds {names}")
    (root,) = bodies
    root.name = root.name or ROOT
    for number, body in enumerate(spec.bodies[1:]):
        body.name = body.name or f"part_{number}"  # scenes and frames go by names
    if not root.joints:
        root.add_freejoint(name=ROOT_JOINT)
    elif [joint.type for joint in root.joints] != [mujoco.mjtJoint.mjJNT_FREE]:
        joints = ", ".join(f"'{joint.name}'" for joint in root.joints)
        raise UsageError(f"{path}: root body '{root.name}' must move freely; take joint {joints} away")


def sort_geoms(spec: mujoco.MjSpec) -> None:
    """Sorts geoms into those that are only seen and those that collide with the world."""
    for geom in spec.geoms:
        seen = geom.contype == geom.conaffinity == 0
        geom.group = SEEN_GROUP if seen else COLLIDING_GROUP
        if not seen:
            geom.contype, geom.conaffinity = COLLIDING


def show_what_collides(spec: mujoco.MjSpec) -> None:
    """Gives a body of which nothing is to be seen the shapes by which it collides."""
    for body in spec.bodies[1:]:
        if any(geom.group == SEEN_GROUP for geom in body.geoms):
            continue
        for geom in list(body.geoms):
            frame = {"pos": geom.pos, "quat": geom.quat, "size": geom.size, "fromto": geom.fromto}
            look = {"rgba": geom.rgba, "material": geom.material, "meshname": geom.meshname}
            body.add_geom(
                type=geom.type, group=SEEN_GROUP, contype=0, conaffinity=0, mass=0.0, **frame, **look
            )


def _put_on(rover: RoverSpec, spec: mujoco.MjSpec) -> None:
    """Gives the wheels the tyres of rover.yaml."""
    tyres, wheels = rover.tyres, set(rover.wheel_joints)
    for body in spec.bodies[1:] if tyres != Tyres() else ():
        if not any(joint.name in wheels for joint in body.joints):
            continue
        for geom in (one for one in body.geoms if one.group == COLLIDING_GROUP):
            sliding, turning, rolling = geom.friction
            geom.friction = [tyres.friction or sliding, tyres.turning or turning, rolling]
            geom.priority = max(geom.priority, 1)
            geom.condim = max(geom.condim, 4) if tyres.turning else geom.condim
            if tyres.radius is not None and geom.type in ROUND:
                geom.size = [tyres.radius, geom.size[1], tyres.radius * bool(geom.size[2])]


def _add_site(spec: mujoco.MjSpec, name: str, mount: Mount | None, path: Path) -> None:
    there = [site for site in spec.sites if site.name == name]
    if there and mount is None:
        return
    for site in there:  # rover.yaml wins
        spec.delete(site)
    mount = mount or Mount(xyz=(0.0, 0.0, _top(spec, path) + ABOVE))
    bodies = {body.name: body for body in spec.bodies[1:]}
    if mount.body and mount.body not in bodies:
        raise UsageError(
            f"{path.parent / 'rover.yaml'}: {name}: body '{mount.body}' does not exist in {path.name}; "
            f"available: {', '.join(filter(None, bodies))}"
        )
    quaternion = np.empty(4)
    mujoco.mju_euler2Quat(quaternion, np.array(mount.rpy), "XYZ")
    bodies[mount.body or root_of(spec)].add_site(
        name=name, pos=mount.xyz, quat=quaternion, group=UNSEEN_GROUP
    )


def _top(spec: mujoco.MjSpec, path: Path) -> float:
    """The highest point of what collides, in the root body's frame, while all joints are at 0 [m]."""
    model = compiled(spec.copy(), path)
    data = at_origin(model)
    _, high = extent(model, data, np.flatnonzero(model.geom_group == COLLIDING_GROUP).tolist())
    return float(high[2]) if np.isfinite(high).all() else 0.0


def extent(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: list[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Returns the lowest and the highest x, y, z of some geoms [m]; infinite for none.

    They are exact: of a mesh its corners count, whose own box leans as its inertia does.

    Args:
        model: The rover's.
        data: Where its bodies are.
        geoms: Their ids.
    """
    low, high = np.full(3, math.inf), np.full(3, -math.inf)
    for geom in geoms:
        place, axes = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
        low = np.minimum(low, place - reach(model, geom, -axes))
        high = np.maximum(high, place + reach(model, geom, axes))
    return low, high


def reach(model: mujoco.MjModel, geom: int, directions: np.ndarray) -> np.ndarray:
    """Returns how far a geom reaches from its place along unit vectors in its frame (n, 3) [m]."""
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = model.mesh(model.geom_dataid[geom])
        corners = model.mesh_vert[mesh.vertadr[0] :][: mesh.vertnum[0]]
        return np.asarray((corners @ directions.T).max(axis=0))
    kind, half = mujoco.mjtGeom(model.geom_type[geom]), model.geom_aabb[geom, 3:]
    level, up = np.hypot(directions[:, 0], directions[:, 1]), np.abs(directions[:, 2])
    own = np.abs(directions) @ half
    if kind in (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_ELLIPSOID):
        own = np.hypot.reduce(directions * half, axis=1)
    elif kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        own = half[0] * level + half[2] * up
    elif kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        own = half[0] + (half[2] - half[0]) * up
    return np.asarray(directions @ model.geom_aabb[geom, :3] + own)


def body_box(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> np.ndarray:
    """Returns `extent` of what collides and is fixed to a body: shape (2, 3) [m].

    Args:
        model: Of the rover alone.
        data: The state in which it is measured.
        body: Number of the body.
    """
    fixed = (model.body_weldid[model.geom_bodyid] == body) & (model.geom_group == COLLIDING_GROUP)
    return np.array(extent(model, data, np.flatnonzero(fixed).tolist()))


def by_side(places: Mapping[str, np.ndarray]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Returns the wheels on the left and those on the right, each front to rear, by their places [m]."""
    ordered = sorted(places, key=lambda name: -places[name][0])
    left = tuple(name for name in ordered if places[name][1] > 0)
    return left, tuple(name for name in ordered if name not in left)


def _check_names(spec: mujoco.MjSpec, path: Path) -> None:
    """Checks that worlds can use the names that they use."""
    named = [*spec.bodies, *spec.geoms, *spec.hfields, *spec.sensors]
    for name in (thing.name for thing in named):
        if name in TAKEN:
            raise UsageError(f"{path}: the name '{name}' is the world's; give another")


def compiled_alone(rover: RoverSpec) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Returns a rover's model without a world, and its state at the origin with all joints at 0."""
    model = copy(_alone(rover, model_hash(rover)))
    return model, at_origin(model)


@lru_cache(maxsize=8)
def _alone(rover: RoverSpec, _: str) -> mujoco.MjModel:
    """A rover's model of that content, to be copied: to read and compile it takes far longer."""
    return compiled(read_model(rover), rover.model_path)


def at_origin(model: mujoco.MjModel) -> mujoco.MjData:
    """Returns the state of a rover's model with its root at the origin and all joints at 0."""
    data = mujoco.MjData(model)
    data.qpos[:], data.qpos[3] = 0.0, 1.0
    mujoco.mj_kinematics(model, data)
    return data


def tip_limit(rover: RoverSpec) -> float:
    """Returns the tilt at which a rover tips over the nearest way, as if it were rigid [rad]."""
    model, data = compiled_alone(rover)
    mujoco.mj_comPos(model, data)
    x, y, z = data.subtree_com[ROOT_ID].tolist()
    wheels = np.array([data.joint(name).xanchor for name in rover.wheel_joints])
    (front, left), (rear, right) = wheels[:, :2].max(axis=0), wheels[:, :2].min(axis=0)
    arm = min(front - x, x - rear, left - y, y - right)
    return math.atan2(arm, z - float(wheels[:, 2].mean()) + rover.wheel_radius)
