"""Draws what the rover's cameras see of a state of the simulation, by OpenGL.

The scene is compiled a second time, with the looks of harness.physics.stage and more grain, for feature
trackers need corners wherever they look. The sun stands still, and nothing shines from the camera: the
faces of a fisheye's cube must agree. It casts no shadows: the dots that a map of them, which moves with
the rover, leaves on slopes would be corners to trackers.
"""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from functools import partial
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.berths import Member
from harness.physics.drawn_ground import DrawnGround
from harness.physics.opengl import Canvas
from harness.physics.stage import (
    FARTHEST,
    NEAREST,
    OBSTACLE_COLORS,
    Quality,
    aim_sun,
    dress,
    visible_groups,
)
from harness.physics.world_geoms import OBSTACLE_BODIES
from harness.robots.model import ROOT_ID
from harness.sensors.camera.sensor import VISIBLE_STATE, CameraOptions, CameraState
from harness.sensors.camera.views import Assembly, View
from harness.world.heightfield import fractal
from harness.world.obstacles import rotation_matrix
from harness.world.world import World

SAMPLES, SHADOW_MAP, SLICES = 4, 16, 16  # nothing casts shadows
MOST_GEOMS = 20_000
SUN_AZIMUTH = -145.0  # [deg] of a camera over whose shoulder it shines
ROCK_PIXELS = 256  # along a side of one face of a cube
# Of rocks and of what has a colour of its own: gain of the colour, which the grain darkens, and
# share of the brightness at one deviation of the grain.
SURFACES = {"rock": (2.0, 0.28), "paint": (1.4, 0.10)}


class CameraRenderer(AbstractContextManager["CameraRenderer"]):
    """Draws for the cameras of one rover in one world; a context manager that gives OpenGL back.

    Args:
        world, fleet: What they see, with all rovers in it.
        cameras: By name.
        context: Of OpenGL, which it takes over.
        seed: Of the noise.
    """

    def __init__(
        self,
        world: World,
        fleet: Sequence[Member],
        cameras: Mapping[str, CameraOptions],
        context: Any,  # noqa: ANN401 - of MuJoCo's, by system
        seed: int = 0,
    ) -> None:
        self._cameras, self._context, self._seed = cameras, context, seed
        self._assemblies = {name: Assembly(camera.lens_of()) for name, camera in cameras.items()}
        views = [view for assembly in self._assemblies.values() for view in assembly.views]
        width, height = max(view.width for view in views), max(view.height for view in views)
        quality = Quality(
            width=width, height=height, samples=SAMPLES, shadow_map=SHADOW_MAP, slices=SLICES
        )
        dressed = partial(_dress, quality=quality)
        self._ground = DrawnGround(world)
        self._model = self._ground.scenes(fleet, 0.002, dressed)[0].model
        self._data = mujoco.MjData(self._model)
        self._canvas = Canvas(self._model, context, MOST_GEOMS)

    def __exit__(self, *_: object) -> None:
        self._canvas.close()
        self._context.free()

    def image(self, name: str, state: CameraState) -> NDArray[np.uint8]:
        """Returns what the camera of a name sees in a state, shape (height, width, 3), RGB."""
        model, data = self._model, self._data
        mujoco.mj_setState(model, data, state.state, VISIBLE_STATE)
        if state.ground is not None:
            self._ground.take(state.ground)
            self._ground.show(*state.position[:2], partial(self._canvas.upload_heights, model))
        mujoco.mj_kinematics(model, data)
        aim_sun(model, data.xpos[ROOT_ID], SUN_AZIMUTH)
        mujoco.mj_camlight(model, data)
        every, scene = mujoco.mjtCatBit.mjCAT_ALL, self._canvas.scene
        mujoco.mjv_updateScene(model, data, visible_groups(), None, mujoco.MjvCamera(), every, scene)
        assembly = self._assemblies[name]
        x, y, z, w = state.orientation
        rotation = rotation_matrix((w, x, y, z))
        seen = []
        for view in assembly.views:
            self._aim(view, np.array(state.position), view.axes @ rotation.T)
            seen.append(self._canvas.drawn(view.width, view.height))
        return self._noisy(assembly.image(seen), self._cameras[name].noise, name, state.stamp_ns)

    def _aim(self, view: View, position: NDArray[np.float64], axes: NDArray[np.float64]) -> None:
        """Puts both eyes of the scene there; `axes` are right, down and ahead in the world, by rows."""
        for eye in self._canvas.scene.camera:
            eye.pos, eye.up, eye.forward = position, -axes[1], axes[2]
            eye.frustum_near, eye.frustum_far = NEAREST, FARTHEST
            eye.frustum_center = NEAREST * 0.5 * (view.left + view.right)
            eye.frustum_width = NEAREST * 0.5 * (view.right - view.left)
            eye.frustum_top, eye.frustum_bottom = -NEAREST * view.top, -NEAREST * view.bottom

    def _noisy(
        self, image: NDArray[np.uint8], deviation: float, name: str, stamp_ns: int
    ) -> NDArray[np.uint8]:
        """The image with noise of its own, whichever other images are drawn."""
        if not deviation:
            return image
        place = list(self._cameras).index(name)
        rng = np.random.default_rng((self._seed, place, stamp_ns))
        noise = rng.normal(0.5, 255.0 * deviation, image.shape)  # a half: rounds
        return np.clip(image + noise, 0.0, 255.0).astype(np.uint8)


def _dress(spec: mujoco.MjSpec, quality: Quality) -> None:
    """Adds soil, sky, sun and rocks with grain to a scene."""
    dress(spec, quality)
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.5] * 3, [0.0] * 3
    for light in spec.lights:
        light.castshadow = False
    _add_grain(spec)


def _add_grain(spec: mujoco.MjSpec) -> None:
    """Gives all obstacles grain in their own colours: those with colours of a file less than rocks."""
    noise = partial(fractal, np.random.default_rng(2), seamless=True)
    grain = noise((ROCK_PIXELS,) * 2, cell=1 / ROCK_PIXELS, longest=1 / 4, shortest=1 / 100, hurst=0.3)
    for name, (_, contrast) in SURFACES.items():
        shade = np.clip(0.7 * (1.0 + contrast * grain), 0.0, 1.0)[..., None]
        size = {"width": ROCK_PIXELS, "height": ROCK_PIXELS, "nchannel": 3}
        texture = spec.add_texture(name=name, type=mujoco.mjtTexture.mjTEXTURE_CUBE, **size)
        texture.data = (255.0 * shade * np.ones(3)).astype(np.uint8).tobytes()
    for body in OBSTACLE_BODIES.values():
        for geom in spec.body(body).geoms:
            is_rock = any(np.allclose(geom.rgba, color) for color in OBSTACLE_COLORS.values())
            surface = "rock" if is_rock else "paint"
            rgba = np.clip(SURFACES[surface][0] * geom.rgba, 0, 1)
            material = spec.add_material(name=f"{surface} {geom.name}", rgba=rgba, specular=0.0)
            material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = surface
            geom.material = material.name
