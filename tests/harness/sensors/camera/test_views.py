"""The views of a lens put together: each pixel of a scene of directions comes from the right place."""

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.camera.lens import Equidistant, Lens, Pinhole
from harness.sensors.camera.views import Assembly, View


def shade(directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """A smooth colour of every direction, 20..235."""
    return np.asarray(127.5 + 107.5 * np.sin(1.3 * directions + np.array([0.3, 1.1, 2.0])))


def drawn(view: View) -> NDArray[np.uint8]:
    """What OpenGL draws of such a scene: straight lines from the eye through the pixels' middles."""
    x = view.left + (np.arange(view.width) + 0.5) / view.width * (view.right - view.left)
    y = view.top + (np.arange(view.height) + 0.5) / view.height * (view.bottom - view.top)
    right, down = np.meshgrid(x, y)
    ahead = np.stack([right, down, np.ones_like(right)], axis=-1) @ view.axes
    unit = ahead / np.linalg.norm(ahead, axis=-1, keepdims=True)
    return np.round(shade(unit)).astype(np.uint8)


@pytest.mark.parametrize(
    ("lens", "views"),
    [
        (Pinhole(40, 30, 1.1), 1),
        (Equidistant(160, 60, 2.8), 3),  # no need to look up, down or back
        (Equidistant(120, 120, 3.1), 5),
        (Equidistant(150, 150, 6.0), 6),
    ],
)
def test_an_image_is_what_each_of_its_pixels_sees(lens: Lens, views: int) -> None:
    assembly = Assembly(lens)
    assert len(assembly.views) == views
    assert all(max(abs(v.left), abs(v.right), abs(v.top), abs(v.bottom)) < 1.1 for v in assembly.views)
    image = assembly.image([drawn(view) for view in assembly.views])
    assert image.shape == (lens.height, lens.width, 3)
    assert image.dtype == np.uint8
    if isinstance(lens, Equidistant):
        directions = lens.directions()
    else:
        ahead = np.stack([*lens.offsets(), np.ones((lens.height, lens.width))], axis=-1)
        directions = ahead / np.linalg.norm(ahead, axis=-1, keepdims=True)
    seen = ~np.isnan(directions[..., 0])
    np.testing.assert_allclose(image[seen], shade(directions[seen]), atol=2.0)
    assert not image[~seen].any()
