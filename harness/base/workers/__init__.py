"""Many runs at once: on processes of this machine, or on the workers of a Ray or Dask cluster."""

import argparse
from collections.abc import Callable

from harness.base.errors import UsageError
from harness.base.workers.local import LocalWorkers
from harness.base.workers.pool import Show, WorkerLost, Workers, work_off
from rover_metrics.plugins import Shipped

__all__ = ["Show", "WorkerLost", "Workers", "add_options", "work_off", "workers_of"]

LOCAL = "local"
CLUSTERS = Shipped[Callable[[str], Workers]](
    "harness.base.workers.clusters", {"ray": ":RayWorkers", "dask": ":DaskWorkers"}
)
CHOICES = "local, ray://HOST:PORT, dask:tcp://HOST:PORT, or ray or dask with --address"


def add_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options whose values `workers_of` takes."""
    parser.add_argument("--jobs", type=int, metavar="N", help="processes (default: one per CPU)")
    about = f"who drives: {CHOICES} (default: %(default)s)"
    parser.add_argument("--backend", default=LOCAL, metavar="WHERE", help=about)
    parser.add_argument("--address", metavar="URL", help="of the Ray or Dask cluster")


def workers_of(backend: str, address: str | None = None, jobs: int | None = None) -> Workers:
    """Returns the workers that a user has chosen, connected.

    Args:
        backend: One of CHOICES.
        address: Of the cluster, where `backend` does not have it.
        jobs: How many local processes; None for one per CPU. A cluster uses all its workers.

    Raises:
        UsageError: The choice is not valid, an extra is missing, the cluster cannot be reached or
            has no worker.
    """
    kind, _, place = backend.partition(":")
    if kind == LOCAL and not place:
        if address is not None:
            raise UsageError("--address needs --backend ray or --backend dask")
        if jobs is not None and jobs < 1:
            raise UsageError(f"{jobs} jobs are not valid; give 1 or more, or leave --jobs out")
        return LocalWorkers(jobs)
    if kind not in CLUSTERS:
        raise UsageError(f"unknown backend '{backend}'; choose one of: {CHOICES}")
    if jobs is not None:
        raise UsageError(f"--jobs is for local processes; --backend {kind} uses all workers there are")
    if bool(place) == bool(address):
        raise UsageError(f"--backend {kind} needs one address of a cluster; choose one of: {CHOICES}")
    if place.startswith("//"):  # a URL of Ray's own client is an address as a whole
        place = backend
    try:
        return CLUSTERS[kind](place or str(address))
    except ModuleNotFoundError as error:
        message = f"--backend {kind} needs {error.name}: pip install 'rover-harness[{kind}]'"
        raise UsageError(message) from error
