"""How kernels are compiled: at import or from the cache on disk, never at the first scan."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numba

P = ParamSpec("P")
R = TypeVar("R")


def kernel(signature: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compiles a function for one signature; it releases the GIL, its code is kept in __pycache__.

    Numba renews the cache when the kernel's own file changes, and only then: a kernel and its
    `inlined` helpers belong in one file. No fastmath, no threads: equal input gives equal bits.
    """
    decorator: Callable[[Callable[P, R]], Callable[P, R]] = numba.njit(
        signature, cache=True, nogil=True, error_model="numpy"
    )
    return decorator


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Marks a helper of a kernel; it is compiled with the kernel that calls it, not by itself."""
    helper: Callable[P, R] = numba.njit(nogil=True, error_model="numpy")(function)
    return helper
