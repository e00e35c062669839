"""Which joints of a URDF are wheels, and which steer them: by their axes and places, no names needed."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError, unknown
from harness.robots.model import at_origin, body_box, by_side

ALONG = 0.9  # cosine of the angle to y of an axle, to z of a steering axis
NEAR_GROUND = 0.3  # of the lowest wheel's radius: wheels reach as low as it
ENDLESS = 4 * np.pi  # [rad] of a joint's range, from which on its limits mean none
TRAIL = 0.2  # of a wheel's radius: so far beside the axis about which it turns freely, it is a caster's
SMALLEST_WHEEL, LARGEST_WHEEL = 0.005, 3.0  # [m] of radius; others are in another unit
LONGEST_PART = 100.0  # of a wheel's radius; a longer one is in another unit
TRACKS = "tracks are rows of wheels here, as many on either side, as those of --template skid6"
IN_METRES = "URDF is in metres: scale its lengths, and meshes by scale="


@dataclass(frozen=True)
class Joints:
    """The joints that matter; left ones front to rear, then right ones."""

    left: tuple[str, ...]  # joints of the left wheels
    right: tuple[str, ...]  # joints of the right wheels
    # of the left and the right front wheel, if those two are steered and no other
    steering: tuple[str, ...]
    # steering joints that are held straight, since no controller here steers so many
    held: tuple[str, ...]
    radius: dict[str, float]  # of each wheel [m]
    backwards: tuple[str, ...]  # wheels and steering whose axes point the other way

    @property
    def wheels(self) -> tuple[str, ...]:
        """The wheels' joints, those on the left first."""
        return self.left + self.right


def find_joints(
    model: mujoco.MjModel, left: tuple[str, ...], right: tuple[str, ...], where: str
) -> Joints:
    """Returns the joints of a rover.

    Args:
        model: Compiled, with a free joint first.
        left: Wheels on the left, front to rear, as the user names them; empty: by their places.
        right: Wheels on the right, front to rear, as the user names them.
        where: The file, for messages.

    Raises:
        UsageError: There are no wheels on one of the sides, or a named one is no hinge.
    """
    data = at_origin(model)
    hinges = [j for j in range(1, model.njnt) if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_HINGE]
    names = {model.joint(j).name: j for j in hinges}
    for name in (*left, *right):
        if name not in names:
            raise UsageError(f"{where}: {unknown('hinge', name, names)}")
    boxes = {name: body_box(model, data, model.jnt_bodyid[j]) for name, j in names.items()}
    if bare := [name for name in (*left, *right) if not np.isfinite(boxes[name]).all()]:
        raise UsageError(f"{where}: the wheel of '{bare[0]}' has no <collision>; give it a shape")
    wheels = [*left, *right] or _rolling(model, data, names, boxes)
    on_left, on_right = by_side({name: boxes[name].mean(axis=0) for name in wheels})
    left, right = left or on_left, right or on_right
    if not (left and right):
        raise UsageError(
            f"{where}: no wheels were found on both sides; name their joints by --left and --right, "
            f"front to rear; hinges: {', '.join(names) or 'none'}{_no_wheels(model, data, names, boxes)}"
        )
    if len(left) != len(right):
        raise UsageError(
            f"{where}: wheels were found as {', '.join(left)} on the left and {', '.join(right)} on the "
            "right; name as many on either side by --left and --right, without casters"
        )
    radius = {name: float(np.ptp(boxes[name], axis=0)[[0, 2]].max() / 2) for name in (*left, *right)}
    for name, length in radius.items():
        if not SMALLEST_WHEEL <= length <= LARGEST_WHEEL:
            raise UsageError(
                f"{where}: the wheel of '{name}' has a radius of {length:.4g} m; {IN_METRES}"
            )
    for body in {*model.body_weldid[1:].tolist()}:
        longest, name = np.ptp(body_box(model, data, body), axis=0).max(), model.body(body).name
        if LONGEST_PART * max(radius.values()) < longest < np.inf:
            raise UsageError(f"{where}: what collides of '{name}' is {longest:.4g} m long; {IN_METRES}")
    steers = {name: _steering_above(model, data, names[name]) for name in (*left, *right)}
    steering = (steers[left[0]], steers[right[0]])
    others = {
        joint for name, joint in steers.items() if joint is not None and name not in (left[0], right[0])
    }
    pair = steering if None not in steering and not others else ()
    held = {joint for joint in steers.values() if joint is not None and joint not in pair}
    turned = [n for n in (*left, *right) if data.xaxis[names[n]][1] < 0]
    turned += [model.joint(j).name for j in {*pair, *held} if data.xaxis[j][2] < 0]
    return Joints(
        left=left,
        right=right,
        steering=tuple(model.joint(joint).name for joint in pair),
        held=tuple(sorted(model.joint(joint).name for joint in held)),
        radius=radius,
        backwards=tuple(turned),
    )


def _no_wheels(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    names: dict[str, int],
    boxes: dict[str, NDArray[np.float64]],
) -> str:
    """Why there are no wheels, for a message: no hinges, nothing of them collides, x is not ahead."""
    bare = [name for name, box in boxes.items() if not np.isfinite(box).all()]
    across = [
        name
        for name, joint in names.items()
        if abs(data.xaxis[joint][0]) > ALONG and _is_endless(model, joint) and name not in bare
    ]
    told = f"; without a <collision>, so no wheels: {', '.join(bare)}" if bare else ""
    told += "" if names else f"; {TRACKS}"
    if across:
        told += (
            f"; about x, which must point ahead: {', '.join(across)}; put a root link before all, whose "
        )
        told += (
            "fixed joint turns by 90 deg about z; of SDF, <include> it so in a <model>, with a <pose>"
        )
    return told


def _rolling(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    names: dict[str, int],
    boxes: dict[str, NDArray[np.float64]],
) -> list[str]:
    """Hinges about y without limits whose shapes reach the ground; none of a caster."""
    rolling = [
        name
        for name, joint in names.items()
        if abs(data.xaxis[joint][1]) > ALONG
        and _is_endless(model, joint)
        and np.isfinite(boxes[name]).all()
        and not _is_on_caster(model, data, joint, boxes[name])
    ]
    if not rolling:
        return []
    lowest = min((boxes[name] for name in rolling), key=lambda box: box[0][2])
    reach = lowest[0][2] + NEAR_GROUND * np.ptp(lowest[:, 2]) / 2
    return [name for name in rolling if boxes[name][0][2] <= reach]


def _is_endless(model: mujoco.MjModel, joint: int) -> bool:
    return not model.jnt_limited[joint] or bool(np.ptp(model.jnt_range[joint]) >= ENDLESS)


def _is_on_caster(
    model: mujoco.MjModel, data: mujoco.MjData, wheel: int, box: NDArray[np.float64]
) -> bool:
    """Whether a wheel trails the joint about z that carries it."""
    swivel = _steering_above(model, data, wheel)
    if swivel is None or not _is_endless(model, swivel):
        return False
    trail = abs(data.xanchor[wheel][0] - data.xanchor[swivel][0])
    return bool(trail > TRAIL * np.ptp(box[:, 2]) / 2)


def _steering_above(model: mujoco.MjModel, data: mujoco.MjData, wheel: int) -> int | None:
    """The joint about z that carries a wheel."""
    body = int(model.body_parentid[model.jnt_bodyid[wheel]])
    while body > 1:
        for joint in range(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body]):
            is_hinge = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE  # no suspension
            if is_hinge and abs(data.xaxis[joint][2]) > ALONG:
                return joint
        body = int(model.body_parentid[body])
    return None
