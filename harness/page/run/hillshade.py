"""Hillshade: a terrain from above, lit from the north-west as on a paper map, and the axes of its map.

Horn's shaded relief (Proc. IEEE 69, 1981) of the terrain's slope; y (up on the page) is north.
"""

import base64
import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from harness.page.figure import Layout, common_layout, titled
from harness.page.run.recorder import Stretch
from harness.world.heightfield import Heightfield

SUN_AZIMUTH, SUN_ELEVATION = np.radians(135.0), np.radians(45.0)  # azimuth from +x to +y
STEEP_LOOK = np.tan(np.radians(35.0))  # how steep the steepest twentieth shall look
MOST_EXAGGERATION = 8.0
DARKEST, BRIGHTEST = 70, 250  # grey levels
MARGIN, SHORTEST_SIDE = 2.0, 8.0  # [m] around the path and of the first view
MOST_PIXELS = 600  # along a side: the picture is most of the page, and few screens show more


@dataclass(frozen=True, eq=False)
class Hillshade:
    """A shaded relief, pixels with row 0 in the north."""

    pixels: NDArray[np.uint8]
    west: float  # x of its left edge [m]; `north` is y of its upper edge [m]
    north: float
    size: tuple[float, float]  # its lengths along x and y [m]
    exaggeration: float  # by what the heights were multiplied before the light fell on them

    def data_uri(self) -> str:
        """Returns the picture as a PNG in a data URI."""
        png = io.BytesIO()
        Image.fromarray(self.pixels).save(png, "png")
        return "data:image/png;base64," + base64.b64encode(png.getvalue()).decode("ascii")


def shade(ground: Heightfield) -> Hillshade:
    """Returns the relief of a ground, a large one at fewer points."""
    stride = -(-max(ground.heights.shape) // MOST_PIXELS)
    heights, cell = ground.heights[::stride, ::stride], ground.cell * stride
    slope_y, slope_x = np.gradient(heights, cell)
    steepness = float(np.percentile(np.hypot(slope_x, slope_y), 95.0))
    exaggeration = min(STEEP_LOOK / max(steepness, 1e-9), MOST_EXAGGERATION)
    sun_x, sun_y = np.cos(SUN_ELEVATION) * np.array([np.cos(SUN_AZIMUTH), np.sin(SUN_AZIMUTH)])
    facing = np.sin(SUN_ELEVATION) - exaggeration * (slope_x * sun_x + slope_y * sun_y)
    light = facing / np.sqrt(1.0 + exaggeration**2 * (slope_x**2 + slope_y**2))
    grey = DARKEST + (BRIGHTEST - DARKEST) * np.clip(light, 0.0, 1.0)
    # A pixel lies around its vertex, so the picture reaches half a pixel beyond the outermost.
    west, south = (low - 0.5 * cell for low in ground.bounds()[::2])
    depth, width = (cell * count for count in heights.shape)
    pixels = np.flipud(grey.round().astype(np.uint8))
    return Hillshade(pixels, west, south + depth, (width, depth), exaggeration)


def map_layout(ground: Heightfield, hillshade: Hillshade, track: Sequence[Stretch]) -> Layout:
    """Returns axes of one scale, in metres of the world, over the terrain as a picture.

    Args:
        ground: The terrain.
        hillshade: The picture.
        track: Path of the rover, which the view shows whole.
    """
    x_range, y_range = _view(track, ground)
    place = {"xref": "x", "yref": "y", "x": hillshade.west, "y": hillshade.north}
    size = {"sizex": hillshade.size[0], "sizey": hillshade.size[1], "sizing": "stretch"}
    look = {"opacity": "--ground-opacity", "layer": "below"}
    picture = {"source": hillshade.data_uri(), **place, **size, **look}
    axis = {"showgrid": False, "constrain": "domain", "automargin": False}
    return common_layout(
        images=[picture],
        xaxis=titled("x [m]", range=x_range, **axis),
        yaxis=titled("y [m]", range=y_range, scaleanchor="x", **axis),
        margin={"l": 56, "r": 16, "t": 70, "b": 44},
        hovermode="closest",
    )


def _view(track: Sequence[Stretch], ground: Heightfield) -> list[list[float]]:
    """A square around the path, or what there is of it on the map: ranges of x and y."""
    if not track:
        x, x_to, y, y_to = ground.bounds()
        return [[x, x_to], [y, y_to]]
    half_size, origin = np.array(ground.half_size), np.array(ground.middle)
    places = np.array([stretch.position[:2] for stretch in track])
    middle, extent = (places.min(axis=0) + places.max(axis=0)) / 2, np.ptp(places, axis=0).max()
    half = np.minimum(max(extent / 2 + MARGIN, SHORTEST_SIDE / 2), half_size)
    middle = np.clip(middle, origin + half - half_size, origin + half_size - half)
    ranges: list[list[float]] = np.column_stack([middle - half, middle + half]).round(2).tolist()
    return ranges
