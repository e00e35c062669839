"""A model made ready to be looked at: a low sun, sharp shadows, ground with grain, a clear sky."""

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.scene import OBSTACLE_GROUP, TERRAIN_GROUP

SHADOW_REACH = 10.0  # [m] around what is looked at
NEAREST, FARTHEST = 0.05, 150.0  # [m] that the camera sees
SUN_ELEVATION = math.radians(32.0)
SUN_BEARING = math.radians(145.0)  # off the camera's view: over the left shoulder
OBSTACLE_SHADE = 0.68  # darker than the ground
FIELD_OF_VIEW = 38.0  # [deg], vertical
DARK_SOIL, LIGHT_SOIL = (128.0, 82.0, 54.0), (226.0, 168.0, 122.0)  # RGB, 0..255

SKY = (224, 208, 188)  # RGB, 0..255


@dataclass(frozen=True, kw_only=True)
class Quality:
    """What an image may cost.

    Attributes:
        width: Of the image [pixels]; likewise `height`.
        samples: Per pixel, against jagged edges.
        shadow_map: Width of the shadows' map, which spans twice `SHADOW_REACH` [pixels].
        slices: Of everything round.
    """

    width: int
    height: int
    samples: int
    shadow_map: int
    slices: int


def prepare(model: mujoco.MjModel, quality: Quality) -> None:
    """Sets resolution, lenses, shadows and light; call before the renderer is made."""
    model.vis.global_.offwidth, model.vis.global_.offheight = quality.width, quality.height
    model.vis.quality.shadowsize = quality.shadow_map
    model.vis.quality.offsamples = quality.samples
    model.vis.quality.numslices, model.vis.quality.numstacks = quality.slices, quality.slices // 2
    model.vis.global_.fovy = FIELD_OF_VIEW
    model.stat.extent = SHADOW_REACH
    model.vis.map.shadowclip = 1.0
    model.vis.map.znear, model.vis.map.zfar = NEAREST / SHADOW_REACH, FARTHEST / SHADOW_REACH
    model.vis.headlight.ambient[:] = 0.42
    model.vis.headlight.diffuse[:] = 0.14
    model.light_diffuse[:] = (0.98, 0.92, 0.82)
    model.geom_rgba[model.geom_group == OBSTACLE_GROUP, :3] *= OBSTACLE_SHADE
    _paint_ground(model)
    _paint_sky(model)


def aim_sun(model: mujoco.MjModel, at: NDArray[np.float64], azimuth: float) -> None:
    """Shines over the camera's shoulder onto a point, around which shadows are cast.

    Args:
        model: The prepared model.
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


def _paint_ground(model: mujoco.MjModel) -> None:
    """Soil with patches and grain, a tile that repeats without seams."""
    material = model.geom_matid[model.geom("terrain").id]
    texture = model.mat_texid[material, mujoco.mjtTextureRole.mjTEXROLE_RGB]
    width, height = int(model.tex_width[texture]), int(model.tex_height[texture])
    rng = np.random.default_rng(0)
    shape = (height, width)
    shade = 0.55 + 0.10 * _tile(rng, shape, 5.0, 60.0, 0.6) + 0.09 * _tile(rng, shape, 90.0, 400.0, 0.1)
    dark, light = np.array(DARK_SOIL), np.array(LIGHT_SOIL)
    colors = dark + (light - dark) * np.clip(shade, 0.0, 1.0)[..., None]
    start = int(model.tex_adr[texture])
    model.tex_data[start : start + colors.size] = colors.astype(np.uint8).ravel()


def _paint_sky(model: mujoco.MjModel) -> None:
    """One colour: of a gradient, a picture near the horizon shows nothing but bands."""
    sky = model.texture("sky").id
    start, pixels = int(model.tex_adr[sky]), int(model.tex_width[sky] * model.tex_height[sky])
    model.tex_data[start : start + 3 * pixels] = np.tile(np.array(SKY, np.uint8), pixels)


def _tile(
    rng: np.random.Generator, shape: tuple[int, int], longest: float, shortest: float, hurst: float
) -> NDArray[np.float64]:
    """Periodic noise of unit RMS between two frequencies, in cycles per tile."""
    frequency = np.hypot(
        np.fft.fftfreq(shape[0], 1 / shape[0])[:, None], np.fft.rfftfreq(shape[1], 1 / shape[1])
    )
    amplitude = (frequency**2 + longest**2) ** (-0.5 * (hurst + 1.0))
    amplitude *= np.exp(-0.5 * (frequency / shortest) ** 2)
    field = np.fft.irfft2(np.fft.rfft2(rng.standard_normal(shape)) * amplitude, s=shape)
    field -= field.mean()
    return np.asarray(field / field.std())


def visible_groups() -> mujoco.MjvOption:
    """Shows terrain, obstacles and the rover as it looks, not as it collides."""
    option = mujoco.MjvOption()
    option.geomgroup[:] = 0
    option.geomgroup[TERRAIN_GROUP : TERRAIN_GROUP + 3] = 1
    return option
