"""Hillshade: how a terrain looks from above, lit from the north-west as on a paper map.

Horn's shaded relief (Proc. IEEE 69, 1981) of the terrain's slope; y (up on the page) is north.
"""

import base64
import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from harness.world.heightfield import Heightfield

SUN_AZIMUTH, SUN_ELEVATION = np.radians(135.0), np.radians(45.0)  # azimuth from +x to +y
STEEP_LOOK = np.tan(np.radians(35.0))  # how steep the steepest twentieth shall look
MOST_EXAGGERATION = 8.0
DARKEST, BRIGHTEST = 70, 250  # grey levels
MOST_PIXELS = 600  # along a side: the picture is most of the page, and few screens show more


@dataclass(frozen=True, eq=False)
class Hillshade:
    """A shaded relief, a square of pixels with row 0 in the north.

    Attributes:
        west: x of its left edge [m]; `north` is y of its upper edge [m], `side` the length of each.
        exaggeration: By what the heights were multiplied before the light fell on them.
    """

    pixels: NDArray[np.uint8]
    west: float
    north: float
    side: float
    exaggeration: float

    def data_uri(self) -> str:
        """The picture as a PNG in a data URI."""
        png = io.BytesIO()
        Image.fromarray(self.pixels).save(png, "PNG", optimize=True)
        return "data:image/png;base64," + base64.b64encode(png.getvalue()).decode("ascii")


def shade(ground: Heightfield) -> Hillshade:
    """Shades a ground; a large one is taken at fewer points."""
    stride = -(-len(ground.heights) // MOST_PIXELS)
    heights, cell = ground.heights[::stride, ::stride], ground.cell * stride
    slope_y, slope_x = np.gradient(heights, cell)
    steepness = float(np.percentile(np.hypot(slope_x, slope_y), 95.0))
    exaggeration = min(STEEP_LOOK / max(steepness, 1e-9), MOST_EXAGGERATION)
    sun_x, sun_y = np.cos(SUN_ELEVATION) * np.array([np.cos(SUN_AZIMUTH), np.sin(SUN_AZIMUTH)])
    facing = np.sin(SUN_ELEVATION) - exaggeration * (slope_x * sun_x + slope_y * sun_y)
    light = facing / np.sqrt(1.0 + exaggeration**2 * (slope_x**2 + slope_y**2))
    grey = DARKEST + (BRIGHTEST - DARKEST) * np.clip(light, 0.0, 1.0)
    # A pixel lies around its vertex, so the picture reaches half a pixel beyond the outermost.
    west, side = -ground.half_size - 0.5 * cell, cell * len(heights)
    pixels = np.flipud(grey.round().astype(np.uint8))
    return Hillshade(pixels, west, west + side, side, exaggeration)
