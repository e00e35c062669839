"""Where episodes are driven: local processes, or workers of a Ray or Dask cluster."""

from importlib import import_module

from harness.base.errors import UsageError
from harness.tune.backend.base import Backend, WorkerLost
from harness.tune.backend.local import LocalBackend

__all__ = ["BACKENDS", "Backend", "WorkerLost", "backend_of"]

CLUSTERS = {"ray": "RayBackend", "dask": "DaskBackend"}  # by the names of their extras
BACKENDS = ("local", *CLUSTERS)


def backend_of(name: str, address: str | None, jobs: int | None) -> Backend:
    """Returns the backend that a user has chosen, connected.

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
    if name in CLUSTERS:
        return _cluster(name, address, jobs)
    if address is not None:
        raise UsageError(f"--address needs --backend {' or --backend '.join(CLUSTERS)}")
    if jobs is not None and jobs < 1:
        raise UsageError(
            f"{jobs} jobs are not valid; give 1 or more, or leave --jobs out for one per CPU"
        )
    return LocalBackend(jobs)


def _cluster(name: str, address: str | None, jobs: int | None) -> Backend:
    if jobs is not None:
        raise UsageError(
            f"--jobs is for local processes; --backend {name} uses all workers of its cluster"
        )
    if address is None:
        raise UsageError(f"--backend {name} needs the address of a cluster: --address HOST:PORT")
    try:
        module = import_module(f"harness.tune.backend.{name}_cluster")
    except ModuleNotFoundError as error:
        message = f"--backend {name} needs {error.name}: pip install 'rover-harness[{name}]'"
        raise UsageError(message) from error
    backend: Backend = getattr(module, CLUSTERS[name])(address)
    return backend
