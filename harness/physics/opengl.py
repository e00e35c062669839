"""OpenGL without a display: which context there is, and images drawn with it."""

import os
import platform
from contextlib import suppress
from importlib import import_module
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.errors import INSTALL_OPENGL, UsageError

CONTEXTS = ("mujoco.egl", "mujoco.osmesa", "mujoco.cgl", "mujoco.glfw")  # in the order they are tried


def gl_context(user: str, width: int, height: int) -> Any:  # noqa: ANN401 - of MuJoCo's, by system
    """Returns an OpenGL context for images; MUJOCO_GL names which, else whichever works.

    Args:
        user: Needs it, for the message.
        width: Of the largest image [pixels].
        height: Of the largest image [pixels].

    Raises:
        UsageError: There is none.
    """
    chosen = os.environ.get("MUJOCO_GL", "").strip().lower()
    names = (f"mujoco.{chosen}",) if f"mujoco.{chosen}" in CONTEXTS else CONTEXTS
    for name in names:
        with suppress(Exception):  # whatever a missing library brings about
            return import_module(name).GLContext(width, height)
    mend = INSTALL_OPENGL.get(platform.system(), "install its libraries")
    raise UsageError(f"{user} needs OpenGL, and none works here; {mend}")


class Canvas:
    """Draws images of one model, in the context that is given.

    Args:
        model: Its offscreen buffer holds the largest image.
        context: Of OpenGL.
        most_geoms: Of the scene and what is added to it.

    Attributes:
        scene: What is drawn; to be updated by mjv_updateScene.
    """

    def __init__(self, model: mujoco.MjModel, context: Any, most_geoms: int) -> None:  # noqa: ANN401
        self._context = context
        context.make_current()
        self.scene = mujoco.MjvScene(model, most_geoms)
        self._target = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._target)

    def drawn(self, width: int, height: int) -> NDArray[np.uint8]:
        """Returns the image of the scene, shape (height, width, 3), in a new array."""
        self._context.make_current()
        pixels, rect = np.empty((height, width, 3), np.uint8), mujoco.MjrRect(0, 0, width, height)
        mujoco.mjr_render(rect, self.scene, self._target)
        mujoco.mjr_readPixels(pixels, None, rect, self._target)
        return np.ascontiguousarray(pixels[::-1])

    def upload_heights(self, model: mujoco.MjModel, field: int) -> None:
        """Draws from now on what the heights of a heightfield are now."""
        self._context.make_current()
        mujoco.mjr_uploadHField(model, self._target, field)

    def close(self) -> None:
        """Gives the images' memory back; the context stays."""
        self._context.make_current()
        self._target.free()
