"""The version of this project, which pyproject.toml reads and tests hold other files to."""

__version__ = "0.1.0"


def packages() -> dict[str, str]:
    """Returns the versions of what every figure and byte depends on beside this project, by name."""
    from importlib.metadata import version  # noqa: PLC0415 - most starts do without

    return {name: version(name) for name in ("mujoco", "numba", "numpy", "scipy")}
