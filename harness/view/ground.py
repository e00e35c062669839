"""The ground as pictures show it: crests that are sharper than its cells without saw teeth.

A crest that runs aslant through the grid hits some vertices and misses others, and two triangles a cell
make teeth of that, on the sky as in its shadow. A Gaussian of one cell takes them off, cells half as wide
round what is left. It acts only where the slope changes by much within a few cells: grain and gentle
ground are shown as they are driven.
"""

import numpy as np

from harness.world.heightfield import Field, Heightfield, smoothstep

SOFTNESS = 1.0  # [cells] standard deviation
GENTLE, SHARP = 0.8, 1.4  # change of slope at a vertex of the softened ground: nothing, all is softened
NEIGHBOURHOOD = 5  # [vertices] across, of which the sharpest counts
MOST_HALVED = 500_000  # vertices of a ground whose cells are halved: four times as many are drawn


def drawn(ground: Heightfield) -> Heightfield:
    """Returns the ground with its sharp crests softened; the same one if it has none."""
    from scipy.ndimage import gaussian_filter, maximum_filter, zoom  # noqa: PLC0415 - slow to import

    soft = gaussian_filter(ground.heights, SOFTNESS, mode="nearest")
    bend = _bend(soft) / ground.cell
    if bend.max() <= GENTLE:
        return ground
    weight = smoothstep(maximum_filter(bend, NEIGHBOURHOOD), GENTLE, SHARP)
    heights = ground.heights + weight * (soft - ground.heights)
    if heights.size > MOST_HALVED:
        return Heightfield(heights, ground.cell)
    finer = [(2 * count - 1) / count for count in heights.shape]
    return Heightfield(zoom(heights, finer, order=3, mode="nearest"), ground.cell / 2)


def _bend(heights: Field) -> Field:
    """Change of the step from vertex to vertex along x or y, the larger; 0 at the edges."""
    bend = np.zeros_like(heights)
    bend[1:-1] = np.abs(np.diff(heights, 2, axis=0))
    bend[:, 1:-1] = np.maximum(bend[:, 1:-1], np.abs(np.diff(heights, 2, axis=1)))
    return bend
