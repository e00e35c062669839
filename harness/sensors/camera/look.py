"""How a world looks to the rover's cameras: what harness.physics.stage gives it, and more texture.

Feature trackers need corners wherever they look, so rocks have grain, which a picture for people does
without. The sun stands still, and nothing shines from the camera: the faces of a
fisheye's cube must agree. It casts no shadows: their map would have to move with the rover, and the dots
that it leaves on slopes along the sun's rays with it, which trackers take for corners.
"""

from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.stage import OBSTACLE_COLORS, Quality, dress
from harness.physics.world_geoms import OBSTACLE_BODIES
from harness.world.heightfield import fractal

SUN_AZIMUTH = -145.0  # [deg] of a camera over whose shoulder it shines
ROCK_PIXELS = 256  # along a side of one face of a cube
# Of rocks and of what has a colour of its own: gain of the colour, which the grain darkens, and
# share of the brightness at one deviation of the grain.
SURFACES = {"rock": (2.0, 0.28), "paint": (1.4, 0.10)}


def dress_for_cameras(spec: mujoco.MjSpec, quality: Quality) -> None:
    """Adds soil, sky, sun and rocks with grain to a scene."""
    dress(spec, quality)
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.5] * 3, [0.0] * 3
    for light in spec.lights:
        light.castshadow = False
    _add_grain(spec)


def _add_texture(
    spec: mujoco.MjSpec, name: str, kind: mujoco.mjtTexture, pixels: NDArray[np.uint8]
) -> None:
    height, width, channels = pixels.shape
    texture = spec.add_texture(name=name, type=kind, width=width, height=height, nchannel=channels)
    texture.data = pixels.tobytes()


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
