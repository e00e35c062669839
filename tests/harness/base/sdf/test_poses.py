"""SDF's poses and frames, against scipy's rotations and poses written out by hand."""

from xml.etree.ElementTree import fromstring

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.base.sdf.poses import IDENTITY, Frames, inverse, read_pose


def pose_of(text: str, attributes: str = "") -> NDArray[np.float64]:
    return read_pose(fromstring(f"<a><pose {attributes}>{text}</pose></a>"), "a")[0]  # noqa: S314 - ours


@pytest.mark.parametrize(
    ("turn", "attributes", "rotation"),
    [
        ("0.1 -0.2 0.3", "", Rotation.from_euler("xyz", [0.1, -0.2, 0.3])),  # about fixed axes
        ("10 20 30", "degrees='true'", Rotation.from_euler("xyz", [10, 20, 30], degrees=True)),
        ("0.1 0.2 0.3", "degrees='false'", Rotation.from_euler("xyz", [0.1, 0.2, 0.3])),
        ("0.2 -0.4 0.6 1.6", "rotation_format='quat_xyzw'", Rotation.from_quat([0.2, -0.4, 0.6, 1.6])),
    ],
)
def test_a_pose_is_a_place_and_angles_or_a_quaternion(
    turn: str, attributes: str, rotation: Rotation
) -> None:
    pose = pose_of(f"1 2 3 {turn}", attributes)
    np.testing.assert_allclose(pose[:3, :3], rotation.as_matrix(), atol=1e-15)
    np.testing.assert_array_equal(pose[:, 3], [1, 2, 3, 1])
    np.testing.assert_allclose(inverse(pose), np.linalg.inv(pose), atol=1e-15)


def test_frames_in_a_circle_or_without_a_name_are_refused() -> None:
    frames = Frames("world")
    frames.add("a", IDENTITY, "b")
    frames.add("b", IDENTITY, "a")
    with pytest.raises(UsageError, match="given in a circle: a in b in a"):
        frames.find("a")
    for name in ("c", "c::d", "::a", "a::"):
        with pytest.raises(UsageError, match=f"frame '{name}' does not exist; available: a, b$"):
            frames.find(name)
    with pytest.raises(UsageError, match=r"frame 'c' does not exist; available: none$"):
        Frames("world").find("c")
