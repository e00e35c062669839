"""The workers of a Ray cluster."""

import logging
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any

import ray
from ray.exceptions import RayError, RayTaskError

from harness.base.interrupt import HANDLED
from harness.tune.backend.address import ClusterKind
from harness.tune.backend.base import WorkerLost
from harness.tune.backend.cluster import ClusterBackend

RAY = ClusterKind(
    name="Ray cluster",
    schemes=("ray",),
    names=("auto",),
    trial="""
import sys
import ray
ray.init(address=sys.argv[1], logging_level="error", log_to_driver=False)
print(ray.cluster_resources().get("CPU", 0))
""",
    mend="start one with `ray start --head`, or correct --address",
)


class RayBackend(ClusterBackend):
    """A Ray cluster, to which this process is connected.

    Raises:
        UsageError: It does not answer, or has no worker.
    """

    def __init__(self, address: str) -> None:
        RAY.check(address)
        with _handlers_kept():
            ray.init(address=address, logging_level=logging.ERROR, log_to_driver=False)
        self._address = address
        self._call = ray.remote(lambda call: call())
        self._submitted: list[Any] = []

    def call(self, function: Callable[[], Any]) -> Future[Any]:
        """See ClusterBackend."""
        if not ray.is_initialized():  # the call would start a cluster on this machine, unasked
            raise self._lost()
        reference = self._call.remote(function)
        self._submitted.append(reference)
        future: Future[Any] = reference.future()
        return future

    def explained(self, error: Exception) -> Exception:
        """See ClusterBackend."""
        if isinstance(error, RayTaskError):
            return self.explained(error.cause)
        return self._lost() if isinstance(error, RayError) else error

    def cancel(self) -> None:
        """See ClusterBackend."""
        if ray.is_initialized():  # as above
            for reference in self._submitted:
                ray.cancel(reference, force=True)
        self._submitted.clear()

    def __exit__(self, *_: object) -> None:
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
