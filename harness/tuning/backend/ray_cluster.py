"""The workers of a Ray cluster."""

import logging
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import ray
from ray.exceptions import RayError, RayTaskError

from harness.interrupt import HANDLED
from harness.tuning.backend.address import parse_address, workers_at
from harness.tuning.backend.base import WorkerLost
from harness.tuning.backend.cluster import Cluster

if TYPE_CHECKING:
    from concurrent.futures import Future

SCHEMES, NAMES = ("ray",), ("auto",)
TRIAL = """
import sys
import ray
ray.init(address=sys.argv[1], logging_level="error", log_to_driver=False)
print(ray.cluster_resources().get("CPU", 0))
"""
MEND = "start one with `ray start --head`, or correct --address"


def connect(text: str) -> Cluster:
    """Connects to a cluster.

    Raises:
        UsageError: It does not answer, or has no worker.
    """
    workers_at(parse_address(text, SCHEMES, NAMES), TRIAL, "Ray cluster", MEND)
    with _handlers_kept():
        ray.init(address=text, logging_level=logging.ERROR, log_to_driver=False)
    return RayCluster(text)


class RayCluster(Cluster):
    """A Ray cluster, which gives a dead worker's calls to others by itself.

    Args:
        address: Of it, as messages name it; this process is connected to it.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._call = ray.remote(lambda call: call())
        self._submitted: list[Any] = []

    def submit(self, call: Callable[[], Any]) -> "Future[Any]":
        """See Cluster."""
        if not ray.is_initialized():  # the call would start a cluster on this machine, unasked
            raise self._lost()
        reference = self._call.remote(call)
        self._submitted.append(reference)
        future: Future[Any] = reference.future()
        return future

    def explained(self, error: Exception) -> Exception:
        """See Cluster."""
        if isinstance(error, RayTaskError):
            return self.explained(error.cause)
        if isinstance(error, RayError):
            return self._lost()
        return error

    def cancel(self) -> None:
        """See Cluster."""
        if ray.is_initialized():  # as above
            for reference in self._submitted:
                ray.cancel(reference, force=True)
        self._submitted.clear()

    def close(self) -> None:
        """See Cluster."""
        ray.shutdown()

    def _lost(self) -> WorkerLost:
        return WorkerLost(f"workers of the Ray cluster at {self._address} were lost (out of memory?)")


@contextmanager
def _handlers_kept() -> Iterator[None]:
    """Ray takes SIGTERM for itself; commands of this project answer it in their own way."""
    before = {number: signal.getsignal(number) for number in HANDLED}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
