"""A depth camera's pixels against its intrinsic matrix, its frames against REP-103."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.sensors.depth import DepthOptions
from tests.support.rovers import LEO


@pytest.mark.parametrize(("width", "height", "fov"), [(7, 4, 1.3), (6, 5, 2.9), (1, 1, 0.1)])
def test_each_pixel_looks_where_the_intrinsic_matrix_has_it(width: int, height: int, fov: float) -> None:
    """K d = (column, row, 1), row by row from the top; the outer edges of a row are `fov` apart."""
    camera = DepthOptions(name="eye", width=width, height=height, fov=fov)
    focal = width / 2 / np.tan(fov / 2)
    matrix = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    rows, columns = np.indices((height, width))
    pixels = np.column_stack([columns.ravel(), rows.ravel(), np.ones(width * height)])
    assert camera.directions() @ matrix.T == pytest.approx(pixels)
    assert camera.rays == width * height
    assert camera.focal_length == pytest.approx(focal)


def test_its_optical_frame_is_below_its_mount_and_looks_ahead() -> None:
    told: dict[str, Any] = {"xyz": (0.1, 0.2, 0.3), "rpy": (0.4, 0.5, 0.6)}
    mount, optical = DepthOptions(name="eye", parent="base_link", **told).frames(LEO)
    assert (mount.parent, mount.child, mount.xyz, mount.rpy) == ("base_link", "eye_link", *told.values())
    assert (optical.parent, optical.child) == ("eye_link", "eye_link_optical")
    assert optical.xyz == (0.0, 0.0, 0.0)
    right, down, ahead = Rotation.from_euler("xyz", optical.rpy).as_matrix().T
    assert [*right, *down, *ahead] == pytest.approx([0, -1, 0, 0, 0, -1, 1, 0, 0])
    (alone,) = DepthOptions(name="eye", frame="camera_frame").frames(LEO)  # which Leo has
    assert (alone.parent, alone.child) == ("camera_frame", "camera_frame_optical")


@pytest.mark.parametrize(
    ("told", "message"),
    [
        ({"width": 3, "height": 0}, r"an image of 3 x 0 pixels is not valid; give 1 or more"),
        ({"width": -1, "height": -1}, r"an image of -1 x -1 pixels"),
        ({"fov": np.pi}, r"fov 3\.14159 rad is not valid; give more than 0 and less than pi"),
        ({"fov": -1.0}, r"fov -1 rad"),
        ({"rate": 30}, r"rate 30 Hz does not divide"),
    ],
)
def test_what_is_no_pinhole_is_told(told: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        DepthOptions(name="eye", **told).check()
