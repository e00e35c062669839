"""The workers of a Dask cluster."""

import logging
import warnings
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from typing import Any

from distributed import Client, KilledWorker

from harness.tune.backend.address import ClusterKind
from harness.tune.backend.base import WorkerLost
from harness.tune.backend.cluster import ClusterBackend

DASK = ClusterKind(
    name="Dask cluster",
    schemes=("tcp", "tls"),
    trial="""
import sys
from distributed import Client
with Client(sys.argv[1], set_as_default=False) as client:
    print(len(client.nthreads()))
""",
    mend="start one with `dask scheduler` and `dask worker`, or correct --address",
)
RUNNING = "running"  # a client's status


class DaskBackend(ClusterBackend):
    """A Dask scheduler with its workers.

    Raises:
        UsageError: It does not answer, or has no worker.
    """

    def __init__(self, address: str) -> None:
        DASK.check(address)
        # It logs what it retries; what matters comes as an exception.
        for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
            logging.getLogger(name).setLevel(logging.CRITICAL)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about versions: each worker compares those that matter
            self._client = Client(address, set_as_default=False)
        self._address = address
        self._executor = self._client.get_executor(pure=False)

    def call(self, function: Callable[[], Any]) -> Future[Any]:
        """See ClusterBackend."""
        if self._client.status != RUNNING:
            raise self._lost()
        future: Future[Any] = self._executor.submit(function)
        return future

    def explained(self, error: Exception) -> Exception:
        """See ClusterBackend."""
        match error:
            case KilledWorker():
                return WorkerLost("the workers of the Dask cluster were killed (out of memory?)")
            case CancelledError():
                return self._lost()
        return error

    def cancel(self) -> None:
        """See ClusterBackend."""
        if self._client.status == RUNNING:
            self._executor.shutdown(wait=False)
            self._executor = self._client.get_executor(pure=False)

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def _lost(self) -> WorkerLost:
        return WorkerLost(f"the Dask cluster at {self._address} is gone")
