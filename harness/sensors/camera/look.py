"""How a world looks to the rover's cameras: what harness.physics.stage gives it, and more texture.

Feature trackers need corners wherever they look, so rocks have grain and the sky has clouds, which a
picture for people does without. The sun stands still, and nothing shines from the camera: the faces of a
fisheye's cube must agree. It casts no shadows: their map would have to move with the rover, and the dots
that it leaves on slopes along the sun's rays with it, which trackers take for corners.
"""

from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.scene import OBSTACLE_BODIES
from harness.physics.stage import OBSTACLE_COLORS, SKY, Quality, dress
from harness.world.heightfield import fractal

SUN_AZIMUTH = -145.0  # [deg] of a camera over whose shoulder it shines
SKY_PIXELS, ROCK_PIXELS = 256, 256  # along a side of one face of a cube
ZENITH, CLOUD, HAZE = (118.0, 140.0, 172.0), (240.0, 236.0, 230.0), SKY  # RGB, 0..255
CLOUD_PIXELS, CLOUD_REACH = 512, 6.0  # of the layer of clouds, which repeats; its height is 1
# Of rocks and of what has a colour of its own: gain of the colour, which the grain darkens, and
# share of the brightness at one deviation of the grain.
SURFACES = {"rock": (2.0, 0.28), "paint": (1.4, 0.10)}
# Right, up and ahead of the faces of a skybox in the world's axes, as MuJoCo stacks them.
SKY_FACES = (
    ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    ((0, -1, 0), (0, 0, 1), (-1, 0, 0)),
    ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    ((-1, 0, 0), (0, 0, 1), (0, 1, 0)),
)


def dress_for_cameras(spec: mujoco.MjSpec, quality: Quality) -> None:
    """Adds soil, sun, clouds and rocks with grain to a scene."""
    dress(spec, quality)
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.5] * 3, [0.0] * 3
    for light in spec.lights:
        light.castshadow = False
    spec.delete(spec.texture("sky"))
    _add_texture(spec, "clouds", mujoco.mjtTexture.mjTEXTURE_SKYBOX, _sky())
    _add_grain(spec)


def _add_texture(
    spec: mujoco.MjSpec, name: str, kind: mujoco.mjtTexture, pixels: NDArray[np.uint8]
) -> None:
    height, width, channels = pixels.shape
    texture = spec.add_texture(name=name, type=kind, width=width, height=height, nchannel=channels)
    texture.data = pixels.tobytes()


def _sky() -> NDArray[np.uint8]:
    """The six faces, one below the other."""
    noise = partial(fractal, np.random.default_rng(1), seamless=True)
    layer = noise((CLOUD_PIXELS,) * 2, cell=1 / CLOUD_PIXELS, longest=1 / 3, shortest=1 / 120, hurst=0.5)
    step = (np.arange(SKY_PIXELS) + 0.5) / SKY_PIXELS * 2.0 - 1.0
    faces = []
    for right, up, ahead in np.array(SKY_FACES, dtype=np.float64):
        across, down = np.meshgrid(step, step)
        direction = ahead + across[..., None] * right - down[..., None] * up
        direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
        rise = np.clip(direction[..., 2:], 0.0, 1.0)
        places = direction[..., :2] / np.maximum(rise, 0.05) / CLOUD_REACH * CLOUD_PIXELS
        column, row = (places.astype(np.int64) % CLOUD_PIXELS).transpose(2, 0, 1)
        share = np.clip(0.45 + 0.4 * layer[row, column], 0.0, 1.0)[..., None]
        clear = np.array(HAZE) + (np.array(ZENITH) - np.array(HAZE)) * np.sqrt(rise)
        share = share * np.clip(4.0 * rise, 0.0, 1.0)  # they drown in the haze of the horizon
        faces.append(clear + (np.array(CLOUD) - clear) * share)
    return np.concatenate(faces).clip(0, 255).astype(np.uint8)


def _add_grain(spec: mujoco.MjSpec) -> None:
    """Gives all obstacles grain in their own colours: those with colours of a file less than rocks."""
    noise = partial(fractal, np.random.default_rng(2), seamless=True)
    grain = noise((ROCK_PIXELS,) * 2, cell=1 / ROCK_PIXELS, longest=1 / 4, shortest=1 / 100, hurst=0.3)
    for name, (_, contrast) in SURFACES.items():
        shade = np.clip(0.7 * (1.0 + contrast * grain), 0.0, 1.0)[..., None]
        pixels = (255.0 * shade * np.ones(3)).astype(np.uint8)
        _add_texture(spec, name, mujoco.mjtTexture.mjTEXTURE_CUBE, pixels)
    for body in OBSTACLE_BODIES.values():
        for geom in spec.body(body).geoms:
            is_rock = any(np.allclose(geom.rgba, color) for color in OBSTACLE_COLORS.values())
            surface = "rock" if is_rock else "paint"
            rgba = np.clip(SURFACES[surface][0] * geom.rgba, 0, 1)
            material = spec.add_material(name=f"{surface} {geom.name}", rgba=rgba, specular=0.0)
            material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = surface
            geom.material = material.name
