"""SDF's poses, and the graph of frames that they refer to.

A pose is that of a frame in another one, by default its parent's. Within a model (or a world) frames
have names; `relative_to` and `attached_to` refer to them, `model::frame` to one of a nested model.
"""

import math
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.base.sdf.reader import is_true, numbers

Transform = NDArray[np.float64]  # shape (4, 4): T_parent_child

IDENTITY: Transform = np.eye(4)
FARTHEST = 1e7  # [m] from the origin: coordinates of a map's projection are less


def read_pose(element: Element, owner: str) -> tuple[Transform, str]:
    """Returns T_reference_element and the reference's name, or ""; UsageError if the pose is none."""
    pose = element.find("pose")
    if pose is None:
        return IDENTITY, ""
    reference = pose.get("relative_to", "")  # `frame`, before 1.7, meant nothing
    text = (pose.text or "").strip() or "0 0 0 0 0 0"
    if pose.get("rotation_format") == "quat_xyzw":
        x, y, z, *quaternion = _placed(text, 7, owner)
        return transform((x, y, z), _of_quaternion(np.array(quaternion), owner)), reference
    x, y, z, *angles = _placed(text, 6, owner)
    if is_true(pose.get("degrees", "")):
        angles = [math.radians(angle) for angle in angles]
    return transform((x, y, z), _of_angles(*angles)), reference


def _placed(text: str, count: int, owner: str) -> tuple[float, ...]:
    values = numbers(text, count, f"pose of {owner}")
    if max(map(abs, values[:3])) > FARTHEST:
        raise UsageError(f"pose of {owner} '{text[:60]}' is not valid; give at most {FARTHEST:g} m")
    return values


def transform(
    position: tuple[float, float, float] | NDArray[np.float64], rotation: NDArray[np.float64]
) -> Transform:
    """Returns the 4x4 matrix of a position [m] and a rotation matrix of nine elements."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation.reshape(3, 3), position
    return matrix


def inverse(pose: Transform) -> Transform:
    """Returns T_child_parent of T_parent_child."""
    turned = pose[:3, :3].T
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turned, -turned @ pose[:3, 3]
    return matrix


def _of_angles(roll: float, pitch: float, yaw: float) -> NDArray[np.float64]:
    """The rotation about the fixed axes x, then y, then z."""
    (cr, cp, cy), (sr, sp, sy) = (tuple(map(f, (roll, pitch, yaw))) for f in (math.cos, math.sin))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _of_quaternion(quaternion: NDArray[np.float64], owner: str) -> NDArray[np.float64]:
    length = float(np.linalg.norm(quaternion))
    if length == 0.0:
        raise UsageError(f"pose of {owner} is not valid: its quaternion is 0")
    x, y, z, w = quaternion / length
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + 2.0 * (w * cross + cross @ cross))


class Frames:
    """The frames of one model or world by name, each given in another one.

    Args:
        root: Its own name: `__model__` or `world`.
    """

    def __init__(self, root: str) -> None:
        self._known: dict[str, Transform] = {root: IDENTITY, "": IDENTITY}
        self._given: dict[str, tuple[Transform, str]] = {}
        self._nested: dict[str, Frames] = {}

    def add(self, name: str, pose: Transform, reference: str = "") -> None:
        """Adds a frame; the first one of a name counts.

        Args:
            name: Of the frame.
            pose: In the reference, shape (4, 4).
            reference: Name of a frame that may be added later; "" for the root.
        """
        if name not in self._known:
            self._given.setdefault(name, (pose, reference))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the frames that were added, in that order."""
        return (*self._given,)

    def nest(self, name: str, frames: "Frames") -> None:
        """Adds the frames of a nested model, which itself is added by `add`."""
        self._nested.setdefault(name, frames)

    def find(self, name: str) -> Transform:
        """Returns T_root_frame; UsageError if there is no such frame, or frames are in a circle."""
        return self._find(name, ())

    def _find(self, name: str, asked: tuple[str, ...]) -> Transform:
        if name in self._known:
            return self._known[name]
        if name in asked:
            raise UsageError(f"frames are given in a circle: {' in '.join((*asked, name))}")
        if name in self._given:
            pose, reference = self._given[name]
            pose_in_root = self._find(reference, (*asked, name)) @ pose
        else:
            model, _, inner = name.partition("::")
            if not inner or model not in self._nested:
                names = ", ".join([*self._given][:12]) or "none"
                raise UsageError(f"frame '{name}' does not exist; available: {names}")
            pose_in_root = self._find(model, (*asked, name)) @ self._nested[model].find(inner)
        self._known[name] = pose_in_root
        return pose_in_root
