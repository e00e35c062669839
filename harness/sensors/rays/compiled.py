"""How kernels are compiled: at import or from the cache on disk, never at the first scan."""

import sys
from collections.abc import Callable
from typing import TypeVar

# numba imports coverage.py wherever it is installed: a tenth of a second of each start, for nothing.
if unmeasured := "coverage" not in sys.modules:
    sys.modules["coverage"] = None  # type: ignore[assignment]  # what makes an import fail
import numba

if unmeasured:
    del sys.modules["coverage"]

F = TypeVar("F", bound=Callable[..., object])


def kernel(signature: str) -> Callable[[F], F]:
    """Compiles a function for one signature; it releases the GIL, its code is kept in __pycache__.

    Numba renews the cache when the kernel's own file changes, and only then: a kernel and its
    `inlined` helpers belong in one file. No fastmath, no threads: equal input gives equal bits.
    """
    decorator: Callable[[F], F] = numba.njit(signature, cache=True, nogil=True, error_model="numpy")
    return decorator


def inlined(function: F) -> F:
    """Marks a helper of a kernel; it is compiled with the kernel that calls it, not by itself."""
    helper: F = numba.njit(nogil=True, error_model="numpy")(function)
    return helper
