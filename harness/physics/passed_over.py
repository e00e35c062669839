"""Obstacles that no rover can touch in the ticks that are simulated in one go: MuJoCo passes them over.

In each step MuJoCo goes through all that collides of every body, also of those that stand still: among
150 rocks a tenth of a step. A geom without contact bits it passes over. What a rover might reach keeps
them, so the contacts are the same, to the bit.
"""

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined
from harness.base.sim_time import CONTROL_PERIOD
from harness.physics.scene import Scene

# [m] that a rover may go in a control period beyond its speed now: as at 200 m/s^2.
ROOM = 0.25

# The obstacles: x, y and radius of what contains each [m], shape (obstacles, 3); its geom, its place
# among the bodies, its contype and its conaffinity, (obstacles, 4). The bodies: each, its contype and
# conaffinity, (bodies, 3). MuJoCo's own contype and conaffinity of geoms, then of bodies. The rovers:
# where their poses stand in qpos, their velocities in qvel, (rovers, 2); how far they reach [m].
PassedOver = tuple[
    NDArray[np.float64],
    NDArray[np.int32],
    NDArray[np.int32],
    tuple[NDArray[np.int32], ...],
    NDArray[np.int64],
    NDArray[np.float64],
]


def obstacles_of(scenes: Sequence[Scene], data: mujoco.MjData) -> PassedOver:
    """Returns all that collides of bodies that stand still, but for the world's own: terrain and decks.

    Args:
        scenes: Of the rovers, in one model.
        data: Its state, in which everything is put in its place.
    """
    model = scenes[0].model
    mujoco.mj_kinematics(model, data)
    body_of = model.geom_bodyid
    still = (model.body_weldid[body_of] == 0) & (body_of != 0) & (model.body_mocapid[body_of] < 0)
    geoms = np.flatnonzero(still & ((model.geom_contype | model.geom_conaffinity) != 0))
    bodies, of = np.unique(body_of[geoms], return_inverse=True)
    discs = np.column_stack([data.geom_xpos[geoms, :2], model.geom_rbound[geoms]])
    bits = [model.geom_contype, model.geom_conaffinity, model.body_contype, model.body_conaffinity]
    return (
        np.ascontiguousarray(discs),
        np.column_stack([geoms, of, bits[0][geoms], bits[1][geoms]]).astype(np.int32),
        np.column_stack([bodies, bits[2][bodies], bits[3][bodies]]).astype(np.int32),
        tuple(bits),
        np.array([[scene.qpos_at, model.body_dofadr[scene.root]] for scene in scenes], np.int64),
        np.array([_reach(scene) for scene in scenes]),
    )


def _reach(scene: Scene) -> float:
    """How far from the origin of its root anything of a rover may be [m], however its joints stand."""
    model, far = scene.model, {scene.root: 0.0}
    for body in range(scene.root + 1, model.nbody):  # parents come first
        if model.body_rootid[body] == scene.root:
            own = far[int(model.body_parentid[body])] + float(np.linalg.norm(model.body_pos[body]))
            first, count = model.body_jntadr[body], model.body_jntnum[body]
            far[body] = own + sum(_play(model, joint) for joint in range(first, first + count))
    places = np.linalg.norm(model.geom_pos, axis=1) + model.geom_rbound
    return max(float(far[int(model.geom_bodyid[geom])] + places[geom]) for geom in scene.geoms())


def _play(model: mujoco.MjModel, joint: int) -> float:
    """How far a joint can move what hangs on it away [m]."""
    if model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_SLIDE:
        return 2.0 * float(np.linalg.norm(model.jnt_pos[joint]))
    return float(np.abs(model.jnt_range[joint]).max()) if model.jnt_limited[joint] else np.inf


@inlined
def pass_over(obstacles: PassedOver, qpos: NDArray[np.float64], qvel: NDArray[np.float64]) -> None:
    """Takes the contact bits of what no rover can touch in a control period; `restore` gives them back.

    Args:
        obstacles: Those that may be passed over.
        qpos: Where the rovers are.
        qvel: How fast they are.
    """
    discs, own, bodies, (contype, conaffinity, body_contype, body_conaffinity), rovers, reach = obstacles
    for row in range(bodies.shape[0]):
        body_contype[bodies[row, 0]] = body_conaffinity[bodies[row, 0]] = 0
    for row in range(own.shape[0]):
        geom, body, is_near = own[row, 0], bodies[own[row, 1], 0], False
        for rover in range(reach.size):
            at, moving = rovers[rover]
            x, y = discs[row, 0] - qpos[at], discs[row, 1] - qpos[at + 1]
            speed = np.hypot(qvel[moving], qvel[moving + 1])
            room = discs[row, 2] + reach[rover] + ROOM + CONTROL_PERIOD * speed
            is_near |= not x * x + y * y > room * room  # also where these are no numbers
        contype[geom], conaffinity[geom] = (own[row, 2], own[row, 3]) if is_near else (0, 0)
        body_contype[body] |= contype[geom]
        body_conaffinity[body] |= conaffinity[geom]


@inlined
def restore(obstacles: PassedOver) -> None:
    """Gives all obstacles their contact bits."""
    _, own, bodies, (contype, conaffinity, body_contype, body_conaffinity), _, _ = obstacles
    for row in range(own.shape[0]):
        contype[own[row, 0]], conaffinity[own[row, 0]] = own[row, 2], own[row, 3]
    for row in range(bodies.shape[0]):
        body_contype[bodies[row, 0]], body_conaffinity[bodies[row, 0]] = bodies[row, 1], bodies[row, 2]
