"""Drivers of a user's own: a class in a Python file, by the name python:FILE.py:CLASS.

The class is made from a DriverContext and has `summary`, `senses` and `command`, as a Driver has; with
`head_for` it takes goals. Its code runs with the rights of whoever runs it.
"""

import importlib.util
from functools import lru_cache
from pathlib import Path

from harness.base.errors import UsageError
from harness.base.files import modified_ns
from harness.drivers.base import IN_FILE, Driver

NEEDED = ("summary", "senses", "command")
FORM = f"{IN_FILE}FILE.py:CLASS"


def driver_in(name: str) -> type[Driver]:
    """Returns the class that a name means.

    Raises:
        UsageError: The file cannot be loaded, or has no such class, or that is no driver.
    """
    text, _, cls = name.removeprefix(IN_FILE).rpartition(":")
    path = Path(text)
    if not text or not path.is_file():
        raise UsageError(f"driver '{name}' names no file; give {FORM}")
    return _loaded(path, cls, modified_ns(path))


@lru_cache(maxsize=4)
def _loaded(path: Path, name: str, _modified_ns: int) -> type[Driver]:
    spec = importlib.util.spec_from_file_location(f"driver_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise UsageError(f"driver file {path} is no Python module; give {FORM}")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # whatever a user's file raises
        raise UsageError(f"driver file {path} fails: {type(error).__name__}: {error}") from error
    found = getattr(module, name, None)
    if not isinstance(found, type):
        classes = [key for key, value in vars(module).items() if isinstance(value, type)]
        raise UsageError(f"{path} has no class '{name}'; it has {', '.join(classes) or 'none'}")
    if missing := [key for key in NEEDED if not hasattr(found, key)]:
        raise UsageError(f"{path}: class {name} is no driver: it has no {', '.join(missing)}")
    driver: type[Driver] = found
    return driver
