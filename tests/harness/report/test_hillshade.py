import base64
import io
import math

import numpy as np
import pytest
from PIL import Image

from harness.report.hillshade import map_layout, shade
from harness.report.recorder import Stretch
from harness.world.heightfield import Heightfield
from harness.world.world import build_world


@pytest.mark.parametrize(
    ("slope_x", "slope_y", "light"),
    [
        # Lambert: the cosine between the normal and the sun, in the north-west 45 degrees up.
        (0.0, 0.0, math.sqrt(0.5)),
        (0.7, 0.0, (math.sqrt(0.5) + 0.7 * 0.5) / math.hypot(1.0, 0.7)),
        (-0.7, 0.0, (math.sqrt(0.5) - 0.7 * 0.5) / math.hypot(1.0, 0.7)),
        (0.0, -0.7, (math.sqrt(0.5) + 0.7 * 0.5) / math.hypot(1.0, 0.7)),
        (0.35, -0.35, 1.0),
    ],
)
def test_a_plane_is_as_bright_as_the_cosine_between_its_normal_and_the_sun(
    slope_x: float, slope_y: float, light: float
) -> None:
    """The slope that shows is that of 35 degrees, whatever the plane's own."""
    axis = np.arange(21) * 0.1
    hillshade = shade(Heightfield(slope_x * axis[None, :] + slope_y * axis[:, None], cell=0.1))
    exaggeration = math.tan(math.radians(35.0)) / (math.hypot(slope_x, slope_y) or 1e-9)
    assert hillshade.exaggeration == pytest.approx(min(exaggeration, 8.0))
    x, y = (hillshade.exaggeration * slope for slope in (slope_x, slope_y))
    normal = np.array([-x, -y, 1.0]) / math.sqrt(1.0 + x * x + y * y)
    sun = np.array([-0.5, 0.5, math.sqrt(0.5)])
    assert hillshade.pixels == pytest.approx(np.full((21, 21), 70 + 180 * (normal @ sun)), abs=0.51)
    if hillshade.exaggeration == pytest.approx(1.0, abs=1e-3):
        assert normal @ sun == pytest.approx(light, abs=1e-3)


def test_north_is_up_in_the_hillshade() -> None:
    heights = np.zeros((21, 21))
    heights[18, 5] = 1.0  # north, as y is large
    pixels = shade(Heightfield(heights, cell=0.1)).pixels.astype(int)
    rows, columns = np.nonzero(pixels != pixels[20, 20])
    assert (rows.mean(), columns.mean()) == pytest.approx((2.0, 5.0))


def test_hillshade_is_a_png_whose_pixels_lie_around_the_vertices() -> None:
    hillshade = shade(build_world("rocky", seed=0).ground)
    assert (hillshade.west, hillshade.north) == pytest.approx((-20.05, 20.05))
    kind, data = hillshade.data_uri().split(",")
    assert kind == "data:image/png;base64"
    with Image.open(io.BytesIO(base64.b64decode(data))) as read:
        assert np.array_equal(np.asarray(read), hillshade.pixels)


def test_a_large_terrain_becomes_a_picture_of_bounded_size() -> None:
    hillshade = shade(Heightfield(heights=np.zeros((501, 2501)), cell=0.1))
    assert hillshade.pixels.shape == (101, 501)
    assert hillshade.size == pytest.approx((501 * 0.5, 101 * 0.5))
    assert (hillshade.west, hillshade.north) == pytest.approx((-125.25, 25.25))


@pytest.mark.parametrize(
    ("places", "x", "y"),
    [
        ([], [-30.0, 30.0], [-5.0, 5.0]),
        ([(0.0, 0.0), (2.0, 0.0)], [-3.0, 5.0], [-4.0, 4.0]),  # 8 m at least
        ([(0.0, 0.0), (5.0, 0.0)], [-2.0, 7.0], [-4.5, 4.5]),  # 2 m around the path
        ([(0.0, 0.0), (20.0, 4.0)], [-2.0, 22.0], [-5.0, 5.0]),  # not beyond the map
        ([(29.0, 4.0)], [22.0, 30.0], [-3.0, 5.0]),
    ],
)
def test_the_map_shows_a_square_around_the_path_and_no_more_than_there_is(
    places: list[tuple[float, float]], x: list[float], y: list[float]
) -> None:
    for middle in ((0.0, 0.0), (7.0, -3.0)):
        ground = Heightfield(np.zeros((11, 61)), 1.0, middle)
        moved = [Stretch(1.0, (p[0] + middle[0], p[1] + middle[1], 0.0), 0.0) for p in places]
        layout = map_layout(ground, shade(ground), moved)
        assert layout["xaxis"]["range"] == [end + middle[0] for end in x]
        assert layout["yaxis"]["range"] == [end + middle[1] for end in y]
        (picture,) = layout["images"]
        place = [picture[name] for name in ("x", "y", "sizex", "sizey")]
        assert place == [middle[0] - 30.5, middle[1] + 5.5, 61.0, 11.0]
