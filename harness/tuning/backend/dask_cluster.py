"""The workers of a Dask cluster."""

import logging
import warnings
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from typing import Any

from distributed import Client, KilledWorker

from harness.tuning.backend.address import parse_address, workers_at
from harness.tuning.backend.base import WorkerLost
from harness.tuning.backend.cluster import Cluster

SCHEMES = ("tcp", "tls")
TRIAL = """
import sys
from distributed import Client
with Client(sys.argv[1], set_as_default=False) as client:
    print(len(client.nthreads()))
"""
MEND = "start one with `dask scheduler` and `dask worker`, or correct --address"
RUNNING = "running"  # a client's status


def connect(text: str) -> Cluster:
    """Connects to a scheduler.

    Raises:
        UsageError: It does not answer, or has no worker.
    """
    address = parse_address(text, SCHEMES)
    workers_at(address, TRIAL, "Dask cluster", MEND)
    # It logs what it retries; what matters comes as an exception.
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about versions: each worker compares those that matter
        return DaskCluster(Client(text, set_as_default=False), text)


class DaskCluster(Cluster):
    """A Dask scheduler, which gives a dead worker's calls to others by itself.

    Args:
        client: Connected to it.
        address: Of it, as messages name it.
    """

    def __init__(self, client: Client, address: str) -> None:
        self._client, self._address = client, address
        self._executor = client.get_executor(pure=False)

    def submit(self, call: Callable[[], Any]) -> "Future[Any]":
        """See Cluster."""
        if self._client.status != RUNNING:
            raise self._lost()
        future: Future[Any] = self._executor.submit(call)
        return future

    def explained(self, error: Exception) -> Exception:
        """See Cluster."""
        match error:
            case KilledWorker():
                return WorkerLost("the workers of the Dask cluster were killed (out of memory?)")
            case CancelledError():
                return self._lost()
        return error

    def cancel(self) -> None:
        """See Cluster."""
        if self._client.status == RUNNING:
            self._executor.shutdown(wait=False)
            self._executor = self._client.get_executor(pure=False)

    def close(self) -> None:
        """See Cluster."""
        self._client.close()

    def _lost(self) -> WorkerLost:
        return WorkerLost(f"the Dask cluster at {self._address} is gone")
