"""Helpers of kernels, as a test calls them."""

from collections.abc import Callable
from functools import cache
from typing import Any

from harness.base.compiled import IS_COMPILED, kernel


@cache
def compiled(helper: Callable[..., Any]) -> Callable[..., Any]:
    """Returns an `inlined` helper whose code is kept on disk; its own is compiled in each process."""
    return kernel()(helper.py_func) if IS_COMPILED else helper  # type: ignore[attr-defined]  # numba's
