"""The ground as pictures show it: crests that are sharper than its cells without saw teeth.

A crest that runs aslant through the grid hits some vertices and misses others, and two triangles a cell
make teeth of that, on the sky as in its shadow. A Gaussian of one cell takes them off, halved cells
round what is left. It acts only where the slope changes by much within a few cells: grain and gentle
ground are shown as they are driven.
"""

import numpy as np

from harness.world.heightfield import Heightfield, smoothstep

SOFTNESS = 1.0  # [cells] standard deviation
GENTLE, SHARP = 0.8, 1.4  # change of slope at a vertex of the softened ground: nothing, all is softened
NEIGHBOURHOOD = 5  # [vertices] across, of which the sharpest counts
MOST_HALVED = 500_000  # vertices of a ground whose cells are halved: four times as many are drawn


def drawn(ground: Heightfield) -> Heightfield:
    """Returns the ground with its sharp crests softened; the same one if it has none."""
    from scipy import ndimage  # noqa: PLC0415 - slow to import

    soft = ndimage.gaussian_filter(ground.heights, SOFTNESS, mode="nearest")
    bend = np.abs(ndimage.laplace(soft, mode="nearest")) / ground.cell
    if bend.max() <= GENTLE:
        return ground
    weight = smoothstep(ndimage.maximum_filter(bend, NEIGHBOURHOOD), GENTLE, SHARP)
    heights = ground.heights + weight * (soft - ground.heights)
    if heights.size > MOST_HALVED:
        return Heightfield(heights, ground.cell, ground.middle)
    finer = [(2 * count - 1) / count for count in heights.shape]
    halved = ndimage.zoom(heights, finer, order=3, mode="nearest")
    return Heightfield(halved, ground.cell / 2, ground.middle)
