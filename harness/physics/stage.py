"""A scene made ready to be looked at: a low sun, sharp shadows, ground with grain, a clear sky."""

import math
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.sky import sky
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
    faces, kind = sky(), mujoco.mjtTexture.mjTEXTURE_SKYBOX
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


def visible_groups() -> mujoco.MjvOption:
    """Shows terrain, obstacles and the rover as it looks, not as it collides."""
    option = mujoco.MjvOption()
    option.geomgroup[:] = 0
    option.geomgroup[TERRAIN_GROUP : TERRAIN_GROUP + 3] = 1
    return option
