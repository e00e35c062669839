"""Values that take long to make: once for all workers of a session, whichever needs them first."""

import fcntl
import os
import pickle
from collections.abc import Callable
from typing import TypeVar

import pytest

T = TypeVar("T")


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[], T]) -> T:
    """Returns what `make` returns here, or returned in another worker of this session, by that name."""
    if "PYTEST_XDIST_WORKER" not in os.environ:  # there is no other
        return make()
    kept = factory.getbasetemp().parent / f"{name}.pickle"
    with kept.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not kept.exists():
            kept.write_bytes(pickle.dumps(make()))
    value: T = pickle.loads(kept.read_bytes())  # noqa: S301 - written above
    return value
