"""Which OpenGL images are drawn with, by the name that MUJOCO_GL gives it; loads none."""

import os
import platform
from functools import cache

# By system, in the order in which they are tried.
BACKENDS = {"Linux": ("egl", "osmesa"), "Darwin": ("cgl", "glfw"), "Windows": ("glfw",)}


def backends(chosen: str) -> tuple[str, ...]:
    """Returns what is to be tried on this system: what MUJOCO_GL asks for, else all that draws."""
    return (chosen,) if chosen else BACKENDS.get(platform.system(), BACKENDS["Linux"])


@cache
def keep_opengl_out() -> str:
    """Returns the OpenGL that MUJOCO_GL asked for at first, and switches it off in this process.

    MuJoCo loads what MUJOCO_GL names when it is imported, and fails where that is missing. A run draws
    nothing itself: it must start there too. What draws has a process of its own.
    """
    requested = os.environ.get("MUJOCO_GL", "").strip().lower()
    os.environ["MUJOCO_GL"] = "off"
    return requested
