"""Loaded by each command before all else: the edge of a program, where a known mistake is one line."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module

try:
    from rover_metrics import errors
    from rover_metrics.errors import run_program
except ImportError:  # the sources are here, what they need is not
    print(
        f"harness: rover-harness is not installed in this Python ({sys.version.split()[0]}, "
        f"{sys.executable}); use .venv/bin/python after make setup, or pip install rover-harness",
        file=sys.stderr,
    )
    sys.exit(2)

__all__ = ["begin_program", "loading", "run_program"]


def begin_program(name: str) -> None:
    """Prepares a program for loading its libraries, as rover_metrics' programs are; loads the first."""
    errors.begin_program(name)
    _load_what_all_need()


def _load_what_all_need() -> None:
    """Loads large libraries before a module does that a dozen others are just loading.

    So deep in calls CPython may take memory from the system and give it back in each of them, as is said
    below `run_program`: 36 ms for one module of numpy.
    """
    for library in ("numpy", "pydantic"):
        import_module(library)


@contextmanager
def loading() -> Iterator[None]:
    """Keeps modules that are loaded meanwhile out of every garbage collection: a sixth of the time.

    So is all else that lives by then: where nothing is loaded it stays in, or each run of a process
    would leave its world behind.
    """
    was_enabled, before = gc.isenabled(), len(sys.modules)
    gc.disable()
    try:
        _load_what_all_need()
        yield
    finally:
        if was_enabled:
            if len(sys.modules) > before:
                gc.freeze()
            gc.enable()
