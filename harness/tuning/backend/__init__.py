"""Where episodes are driven: local processes, or workers of a Ray or Dask cluster, through joblib."""

from importlib import import_module
from typing import TYPE_CHECKING

from harness.errors import UsageError
from harness.tuning.backend.base import Backend, WorkerLost
from harness.tuning.backend.cluster import Cluster, ClusterBackend
from harness.tuning.backend.local import LocalBackend, usable_cpus

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["BACKENDS", "Backend", "WorkerLost", "backend_of"]

LOCAL = "local"
CLUSTERS = ("ray", "dask")  # also the names of their extras, and of what these install
BACKENDS = (LOCAL, *CLUSTERS)


def backend_of(name: str, address: str | None, jobs: int | None) -> Backend:
    """The backend that a user has chosen, connected.

    Args:
        name: One of BACKENDS.
        address: Of the cluster; None for local processes.
        jobs: How many local processes; None for one per CPU. A cluster uses all its workers.

    Raises:
        UsageError: The choice is not valid, an extra is missing, the cluster cannot be reached or
            has no worker.
    """
    if name not in BACKENDS:
        raise UsageError(f"unknown backend '{name}'; choose one of: {', '.join(BACKENDS)}")
    if name == LOCAL:
        if address is not None:
            raise UsageError(f"--address needs --backend {' or --backend '.join(CLUSTERS)}")
        return _local(jobs)
    if jobs is not None:
        raise UsageError(
            f"--jobs is for local processes; --backend {name} uses all workers of its cluster"
        )
    return _cluster(name, address)


def _local(jobs: int | None) -> Backend:
    if jobs is not None and jobs < 1:
        raise UsageError(
            f"{jobs} jobs are not valid; give 1 or more, or leave --jobs out for one per CPU"
        )
    return LocalBackend(usable_cpus() if jobs is None else jobs)


def _cluster(name: str, address: str | None) -> Backend:
    if address is None:
        raise UsageError(f"--backend {name} needs the address of a cluster: --address HOST:PORT")
    try:
        workers = import_module(f"harness.tuning.backend.{name}_cluster")
    except ModuleNotFoundError as error:
        message = f"--backend {name} needs {error.name}: pip install 'rover-harness[{name}]'"
        raise UsageError(message) from error
    connect: Callable[[str], Cluster] = workers.connect
    return ClusterBackend(connect(address))
