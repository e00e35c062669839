"""The sky over every world: clouds that drown in the haze of the horizon."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from harness.world.heightfield import fractal

SKY_PIXELS = 256  # along a side of one face of a cube
ZENITH, CLOUD, HAZE = (118, 140, 172), (240, 236, 230), (224, 208, 188)  # RGB, 0..255
CLOUD_PIXELS, CLOUD_REACH = 512, 6.0  # of the layer of clouds, which repeats; its height is 1
LOWEST = 0.05  # sine of the elevation from which on there are clouds
# Right, up and ahead of the faces of a skybox in the world's axes, as MuJoCo stacks them.
SKY_FACES = (
    ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    ((0, -1, 0), (0, 0, 1), (-1, 0, 0)),
    ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    ((-1, 0, 0), (0, 0, 1), (0, 1, 0)),
)


def sky() -> NDArray[np.uint8]:
    """Returns the six faces of a skybox, one below the other, shape (6 n, n, 3)."""
    noise = partial(fractal, np.random.default_rng(1), seamless=True)
    layer = noise((CLOUD_PIXELS,) * 2, cell=1 / CLOUD_PIXELS, longest=1 / 3, shortest=1 / 120, hurst=0.5)
    step = (np.arange(SKY_PIXELS) + 0.5) / SKY_PIXELS * 2.0 - 1.0
    faces = []
    for right, up, ahead in np.array(SKY_FACES, dtype=np.float64):
        across, down = np.meshgrid(step, step)
        direction = ahead + across[..., None] * right - down[..., None] * up
        direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
        rise = np.clip(direction[..., 2:], 0.0, 1.0)
        places = direction[..., :2] / np.maximum(rise, LOWEST) / CLOUD_REACH * CLOUD_PIXELS
        column, row = (places.astype(np.int64) % CLOUD_PIXELS).transpose(2, 0, 1)
        share = np.clip(0.45 + 0.4 * layer[row, column], 0.0, 1.0)[..., None]
        clear = np.array(HAZE) + (np.array(ZENITH) - np.array(HAZE)) * rise**0.75
        share = share * np.clip(4.0 * (rise - LOWEST), 0.0, 1.0)  # they drown in the haze of the horizon
        faces.append(clear + (np.array(CLOUD) - clear) * share)
    return np.concatenate(faces).clip(0, 255).astype(np.uint8)
