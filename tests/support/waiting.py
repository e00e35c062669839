"""Waiting for what another process does, without a fixed time."""

import select
import time
from collections.abc import Callable

PATIENCE = 60.0  # [s]; reached only when a test fails
GLANCE = 0.02  # [s]


def wait_until(condition: Callable[[], object], patience: float = PATIENCE) -> None:
    """Looks until another process has made a condition true.

    Args:
        condition: What is looked at, a few dozen times a second.
        patience: Seconds of wall time after which the test fails.
    """
    deadline = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < deadline, "the condition did not come true"
        select.select([], [], [], GLANCE)
