"""Lenses against the textbook: K of a pinhole, the evenly spaced angles of an equidistant fisheye."""

import math

import numpy as np
import pytest

from harness.sensors.camera.lens import Equidistant, Pinhole


def test_k_of_roboterrains_cameras() -> None:
    """Half the width over the tangent of half the angle; 1600 pixels over 2.8 rad."""
    pinhole, fisheye = Pinhole(640, 480, 1.1), Equidistant(1600, 600, 2.8)
    assert pinhole.matrix == pytest.approx(
        np.array([[320 / math.tan(0.55), 0, 319.5], [0, 320 / math.tan(0.55), 239.5], [0, 0, 1]])
    )
    assert fisheye.matrix == pytest.approx(
        np.array([[1600 / 2.8, 0, 799.5], [0, 1600 / 2.8, 299.5], [0, 0, 1]])
    )
    assert [(one.distortion_model, one.coefficients) for one in (pinhole, fisheye)] == [
        ("plumb_bob", 5),
        ("equidistant", 4),
    ]


@pytest.mark.parametrize("lens", [Equidistant(7, 5, 2.8), Equidistant(8, 8, 6.0)])
def test_every_pixel_of_a_fisheye_is_projected_back_to_where_it_is(lens: Equidistant) -> None:
    """By what OpenCV documents of its fisheye model: r = theta."""
    directions = lens.directions()
    rows, columns = np.indices((lens.height, lens.width), dtype=float)
    x, y, z = np.moveaxis(directions, -1, 0)
    radius, around = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)
    seen = ~np.isnan(z)
    back = (
        lens.matrix[0, 0] * radius * np.cos(around) + lens.matrix[0, 2],
        lens.matrix[1, 1] * radius * np.sin(around) + lens.matrix[1, 2],
    )
    for told, expected in zip(back, (columns, rows), strict=True):
        np.testing.assert_allclose(told[seen], expected[seen], atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=-1)[seen], 1.0)
    assert seen.all() == (lens.fov < 6.0)  # its corners would be more than 180 degrees off
