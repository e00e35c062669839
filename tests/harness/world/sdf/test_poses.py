"""SDF's poses and frames, against scipy's rotations and poses written out by hand."""

from xml.etree.ElementTree import Element, fromstring

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.errors import UsageError
from harness.world.sdf.poses import IDENTITY, Frames, inverse, read_pose


def pose_of(text: str, attributes: str = "") -> NDArray[np.float64]:
    return read_pose(fromstring(f"<a><pose {attributes}>{text}</pose></a>"), "a")[0]  # noqa: S314 - ours


def test_angles_are_about_fixed_axes_x_then_y_then_z() -> None:
    pose = pose_of("1 2 3 0.1 -0.2 0.3")
    np.testing.assert_allclose(pose[:3, :3], Rotation.from_euler("xyz", [0.1, -0.2, 0.3]).as_matrix())
    np.testing.assert_array_equal(pose[:, 3], [1, 2, 3, 1])
    np.testing.assert_allclose(inverse(pose), np.linalg.inv(pose), atol=1e-15)


def test_angles_may_be_degrees_or_a_quaternion() -> None:
    np.testing.assert_allclose(
        pose_of("0 0 0 10 20 30", 'degrees="true"')[:3, :3],
        Rotation.from_euler("xyz", [10, 20, 30], degrees=True).as_matrix(),
    )
    np.testing.assert_allclose(
        pose_of("0 0 0 0.2 -0.4 0.6 1.6", 'rotation_format="quat_xyzw"')[:3, :3],
        Rotation.from_quat([0.2, -0.4, 0.6, 1.6]).as_matrix(),
    )
    with pytest.raises(UsageError, match="quaternion is 0"):
        pose_of("0 0 0 0 0 0 0", 'rotation_format="quat_xyzw"')


def test_without_a_pose_it_is_the_parents_and_frame_of_old_files_means_nothing() -> None:
    assert read_pose(Element("a"), "a") == (IDENTITY, "")
    old = fromstring("<a><pose frame='elsewhere'/></a>")  # noqa: S314 - ours
    pose, reference = read_pose(old, "a")
    np.testing.assert_array_equal(pose, np.eye(4))
    assert reference == ""


def test_frames_are_found_through_others_in_any_order_and_in_nested_models() -> None:
    frames, inner = Frames("world"), Frames("__model__")
    frames.add("b", pose_of("0 1 0 0 0 1.5707963267948966"), "a")
    frames.add("a", pose_of("1 0 0 0 0 0"))
    inner.add("link", pose_of("2 0 0 0 0 0"))
    frames.nest("b", inner)
    np.testing.assert_allclose(frames.find("b::link")[:3, 3], [1.0, 3.0, 0.0], atol=1e-12)
    np.testing.assert_array_equal(frames.find("world"), np.eye(4))


def test_frames_in_a_circle_or_without_a_name_are_refused() -> None:
    frames = Frames("world")
    frames.add("a", IDENTITY, "b")
    frames.add("b", IDENTITY, "a")
    with pytest.raises(UsageError, match="told in a circle: a in b in a"):
        frames.find("a")
    with pytest.raises(UsageError, match=r"frame 'c' does not exist; available: a, b$"):
        frames.find("c")
    for name in ("c::d", "::a", "a::"):
        with pytest.raises(UsageError, match=f"frame '{name}' does not exist; available: a, b"):
            frames.find(name)
    with pytest.raises(UsageError, match=r"frame 'c' does not exist; available: none$"):
        Frames("world").find("c")
