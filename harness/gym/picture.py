"""An environment as an image or in a window: the rover from behind, its world, its goal.

OpenGL is loaded when something is first drawn, and from where it works without a display; what does
not draw needs none.
"""

import warnings
from dataclasses import replace
from functools import partial
from importlib import import_module
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.gym.course import Course
from harness.gym.driven_rover import DrivenRover
from harness.physics.berths import Member
from harness.physics.drawn_ground import DrawnGround
from harness.physics.opengl import Canvas, gl_context
from harness.physics.stage import Quality, aim_sun, dress, visible_groups
from harness.view.camera import chase_view
from harness.view.ground import drawn
from harness.view.marks import Mark, add_marks

QUALITY = Quality(width=640, height=400, samples=4, shadow_map=2048, slices=16)
GOAL_COLOR = (0.05, 0.78, 0.86, 0.6)
GOAL_SIZE = (0.05, 0.6, 0.0)  # [m] radius and half height of the post that marks the goal
MOST_GEOMS = 10_000


class Painter:
    """Draws episodes of one environment; compiles a world's looks when it is first drawn.

    Args:
        window: Whether to draw into a window instead of images.

    Raises:
        UsageError: There is no display for the window, or no OpenGL.
    """

    def __init__(self, *, window: bool) -> None:
        self._window, self._context = window, None
        if not window:
            self._context = gl_context("render_mode 'rgb_array'", QUALITY.width, QUALITY.height)
        elif not _has_display():
            raise UsageError("render_mode 'human' needs a display; use render_mode 'rgb_array'")
        self._course: Course | None = None
        self._view: Any = None  # a Canvas, or a window of MuJoCo's

    def draw(
        self,
        course: Course,
        driven: DrivenRover,
        goal: tuple[float, float],
        steps: int,  # noqa: ARG002 - what a LiveView is told
    ) -> NDArray[np.uint8] | None:
        """Draws a state; the image, shape (height, width, 3), or None into a window.

        Args:
            course: The world.
            driven: The rover.
            goal: In the world [m].
            steps: Since the episode began; an image does not tell them.
        """
        shown = driven.simulation
        if course is not self._course:
            self._leave()
            self._stage(course)
        now = self._data
        now.qpos[:] = shown.data.qpos
        now.mocap_pos[:], now.mocap_quat[:] = shown.data.mocap_pos, shown.data.mocap_quat  # people
        x, y, _ = shown.position
        if shown.physics.bed is not None and (patch := shown.physics.bed.around(x, y)) is not None:
            self._ground.take(patch)
            self._ground.show(x, y, self._upload)
        mujoco.mj_forward(self._model, self._data)
        if self._window:
            self._view.sync()
            return None
        ground = course.scene.world.ground
        foot = np.array([*goal, ground.height_at(*goal) + GOAL_SIZE[1]])
        post = Mark(mujoco.mjtGeom.mjGEOM_CYLINDER, GOAL_SIZE, foot, GOAL_COLOR, glow=0.5)
        return self._image(post)

    def close(self) -> None:
        """Closes the window and gives OpenGL back; it cannot draw any more."""
        self._leave()
        if self._context is not None:
            self._context.free()

    def _stage(self, course: Course) -> None:
        scene = course.scene
        self._ground = DrawnGround(scene.world)
        if not self._ground.leaves_ruts:
            self._ground = DrawnGround(replace(scene.world, ground=drawn(scene.world.ground)))
        fleet, dressed = (Member("", scene.rover, scene.world.start),), partial(dress, quality=QUALITY)
        self._model = self._ground.scenes(fleet, course.run.timestep, dressed)[0].model
        self._data = mujoco.MjData(self._model)
        if self._window:
            viewer = import_module("mujoco.viewer")
            self._view = viewer.launch_passive(self._model, self._data)
            self._upload = self._view.update_hfield
        else:
            self._view = Canvas(self._model, self._context, MOST_GEOMS)
            self._upload = partial(self._view.upload_heights, self._model)
        self._course = course

    def _leave(self) -> None:
        if self._view is not None:
            self._view.close()
        self._view = self._course = None

    def _image(self, mark: Mark) -> NDArray[np.uint8]:
        """The image of the state, shape (height, width, 3)."""
        model, data, scene = self._model, self._data, self._view.scene
        position, forward = data.qpos[:3].copy(), data.body(1).xmat.reshape(3, 3)[:, 0]
        view = chase_view(position, float(np.arctan2(forward[1], forward[0])))
        aim_sun(model, position, view.azimuth)
        mujoco.mj_camlight(model, data)
        every = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(model, data, visible_groups(), None, view.camera(), every, scene)
        add_marks(scene, [mark], 0.0)
        scene.flags[mujoco.mjtRndFlag.mjRND_HAZE] = True
        image: NDArray[np.uint8] = self._view.drawn(QUALITY.width, QUALITY.height)
        return image


def _has_display() -> bool:
    """Whether a window can be opened: MuJoCo's would wait for ever where none can."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the caller reports it in a line
        return bool(import_module("glfw").init())
