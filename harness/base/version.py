"""The version of this project, which pyproject.toml reads and tests hold other files to."""

from functools import cache

__version__ = "0.1.0"


def packages() -> dict[str, str]:
    """Returns the versions of what every figure and byte depends on beside this project, by name."""
    return {name: _installed(name) for name in ("mujoco", "numba", "numpy", "scipy")}


@cache
def _installed(name: str) -> str:
    from importlib.metadata import version  # noqa: PLC0415 - most starts do without

    return version(name)
