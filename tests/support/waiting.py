"""Waiting for what another process does, without a fixed time; where it may listen meanwhile."""

import os
import select
import socket
import time
from collections.abc import Callable

PATIENCE = 180.0  # [s]; reached only when a test fails
GLANCE = 0.02  # [s]


def wait_until(condition: Callable[[], object], patience: float = PATIENCE) -> None:
    """Looks until another process has made a condition true, so long [s] before the test fails."""
    deadline = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < deadline, "the condition did not come true"
        select.select([], [], [], GLANCE)


def free_port() -> int:
    """Returns a port that nobody on this machine listens on."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port: int = server.getsockname()[1]
        return port


def under_load(limit: float) -> float:
    """Returns a limit of wall time [s] for what shares its cores with the machine's other work."""
    return limit * max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))
