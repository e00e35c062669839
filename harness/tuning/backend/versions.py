"""What a worker elsewhere must have in common with this process, or its bytes could differ."""

import platform
import zlib
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from harness import __version__

PACKAGES = ("mujoco", "numba", "numpy", "scipy")


@cache
def versions() -> Mapping[str, str]:
    """The versions of this process, by name."""
    return {
        "rover-harness": __version__,
        "Python": ".".join(platform.python_version_tuple()[:2]),
        "CPU": platform.machine(),
        "zlib": zlib.ZLIB_RUNTIME_VERSION,
        **{package: _version(package) for package in PACKAGES},
    }


def difference(theirs: Mapping[str, str], ours: Mapping[str, str]) -> str | None:
    """What tells two sets of versions apart, in a few words; None if nothing does."""
    told = [
        f"{name} {theirs.get(name, '?')} instead of {version}"
        for name, version in ours.items()
        if theirs.get(name) != version
    ]
    return ", ".join(told) or None


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "none"
