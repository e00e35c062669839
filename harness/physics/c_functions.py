"""MuJoCo's functions as compiled kernels call them: by their addresses."""

import ctypes
import sys
from functools import cache
from pathlib import Path

import mujoco

LIBRARIES = {"win32": "mujoco.dll", "darwin": f"libmujoco.{mujoco.__version__}.dylib"}


@cache
def address_of(function: str) -> int:
    """Returns the address of a function of MuJoCo in this process."""
    name = LIBRARIES.get(sys.platform, f"libmujoco.so.{mujoco.__version__}")
    library = ctypes.CDLL(str(Path(mujoco.__file__).with_name(name)))
    return ctypes.cast(library[function], ctypes.c_void_p).value or 0


def addresses() -> tuple[int, int, int, int]:
    """Returns the addresses of mj_contactForce, mj_step, mj_step1 and mj_step2 in this process."""
    force, step = address_of("mj_contactForce"), address_of("mj_step")
    return force, step, address_of("mj_step1"), address_of("mj_step2")
