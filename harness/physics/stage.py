"""A scene made ready to be looked at: a low sun, sharp shadows, ground with grain, a clear sky."""

import math
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.world_geoms import OBSTACLE_BODIES, TERRAIN, TERRAIN_GROUP, UNPAINTED
from harness.world.heightfield import fractal
from harness.world.obstacles import ObstacleKind

SHADOW_REACH = 10.0  # [m] around what is looked at
NEAREST, FARTHEST = 0.05, 150.0  # [m] that the camera sees
SUN_ELEVATION = math.radians(32.0)
SUN_BEARING = math.radians(145.0)  # off the camera's view: over the left shoulder
OBSTACLE_COLORS = {  # RGBA, darker than the ground
    ObstacleKind.ROCK: [0.3128, 0.272, 0.238, 1.0],
    ObstacleKind.HAZARD: [0.4216, 0.204, 0.136, 1.0],
    ObstacleKind.DECK: [0.51, 0.40, 0.31, 1.0],
}
PERSON_COLOR = [0.13, 0.28, 0.46, 1.0]
FIELD_OF_VIEW = 38.0  # [deg], vertical
SOIL_PIXELS, SOIL_TILE = 1024, 2.0  # [pixels], [m] along a side of what repeats
DARK_SOIL, LIGHT_SOIL = (128.0, 82.0, 54.0), (226.0, 168.0, 122.0)  # RGB, 0..255

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


@dataclass(frozen=True, kw_only=True)
class Quality:
    """What an image may cost."""

    width: int  # [pixels]
    height: int  # [pixels]
    samples: int  # per pixel, against jagged edges
    shadow_map: int  # width of the shadows' map, which spans twice `SHADOW_REACH` [pixels]
    slices: int  # of everything round


def dress(spec: mujoco.MjSpec, quality: Quality) -> None:
    """Adds soil, sky and sun to a scene, and sets resolution, lenses and shadows."""
    view = spec.visual
    view.global_.offwidth, view.global_.offheight = quality.width, quality.height
    view.global_.fovy = FIELD_OF_VIEW
    view.quality.shadowsize, view.quality.offsamples = quality.shadow_map, quality.samples
    view.quality.numslices, view.quality.numstacks = quality.slices, quality.slices // 2
    view.map.shadowclip = 1.0
    view.map.znear, view.map.zfar = NEAREST / SHADOW_REACH, FARTHEST / SHADOW_REACH
    view.headlight.ambient, view.headlight.diffuse = [0.42] * 3, [0.14] * 3
    view.headlight.specular = [0.0] * 3
    spec.stat.extent = SHADOW_REACH
    spec.worldbody.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, diffuse=[0.98, 0.92, 0.82], castshadow=True
    )
    for kind, body in (*OBSTACLE_BODIES.items(), (ObstacleKind.DECK, "world")):
        for geom in spec.body(body).geoms:
            if geom.name != TERRAIN and np.allclose(geom.rgba, UNPAINTED):
                geom.rgba = OBSTACLE_COLORS[kind]
    for body in spec.bodies:
        for geom in body.geoms if body.mocap else ():
            geom.rgba = PERSON_COLOR
    _add_soil(spec)
    faces, kind = _sky(), mujoco.mjtTexture.mjTEXTURE_SKYBOX
    texture = spec.add_texture(
        name="sky", type=kind, width=faces.shape[1], height=faces.shape[0], nchannel=3
    )
    texture.data = faces.tobytes()


def aim_sun(model: mujoco.MjModel, at: NDArray[np.float64], azimuth: float) -> None:
    """Shines over the camera's shoulder onto a point, around which shadows are cast.

    Args:
        model: The dressed scene.
        at: Point in the world [m].
        azimuth: Direction in which the camera looks [deg].
    """
    bearing = math.radians(azimuth) + SUN_BEARING
    level = math.cos(SUN_ELEVATION)
    towards_sun = np.array(
        [level * math.cos(bearing), level * math.sin(bearing), math.sin(SUN_ELEVATION)]
    )
    model.light_dir[:] = -towards_sun
    model.light_pos[:] = at + SHADOW_REACH * towards_sun


def _add_soil(spec: mujoco.MjSpec) -> None:
    """Soil with patches and grain, a tile that repeats without seams."""
    rng, cell = np.random.default_rng(0), 1.0 / SOIL_PIXELS
    noise = partial(fractal, rng, (SOIL_PIXELS, SOIL_PIXELS), cell=cell, seamless=True)
    patches = noise(longest=1 / 5, shortest=1 / 60, hurst=0.6)
    grain = noise(longest=1 / 90, shortest=1 / 400, hurst=0.1)
    dark, light = np.array(DARK_SOIL), np.array(LIGHT_SOIL)
    shade = np.clip(0.55 + 0.10 * patches + 0.09 * grain, 0.0, 1.0)[..., None]
    texture = spec.add_texture(
        name="ground",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        width=SOIL_PIXELS,
        height=SOIL_PIXELS,
        nchannel=3,
    )
    texture.data = (dark + (light - dark) * shade).astype(np.uint8).tobytes()
    half_x, half_y, *_ = spec.hfield(TERRAIN).size
    repeat = [2 * half_x / SOIL_TILE, 2 * half_y / SOIL_TILE]
    material = spec.add_material(name="ground", texrepeat=repeat, specular=0.0, reflectance=0.0)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "ground"
    spec.geom(TERRAIN).material = "ground"


def _sky() -> NDArray[np.uint8]:
    """Clouds that drown in the haze of the horizon: faces of a skybox, stacked, shape (6 n, n, 3)."""
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


def visible_groups() -> mujoco.MjvOption:
    """Shows terrain, obstacles and the rover as it looks, not as it collides."""
    option = mujoco.MjvOption()
    option.geomgroup[:] = 0
    option.geomgroup[TERRAIN_GROUP : TERRAIN_GROUP + 3] = 1
    return option
