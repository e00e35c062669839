"""Workers of a cluster that the user already has: what Ray and Dask have in common."""

import pickle
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Generic

from joblib import Parallel, delayed
from joblib.parallel import ParallelBackendBase

from harness import __version__
from harness.errors import UsageError
from harness.tuning.backend.base import Backend, Item, Outcome, closed_quietly
from harness.tuning.backend.versions import difference, versions

if TYPE_CHECKING:
    from concurrent.futures import Future

_busy = threading.Lock()


class Cluster(ABC):
    """A connection to a cluster."""

    @abstractmethod
    def submit(self, call: Callable[[], Any]) -> "Future[Any]":
        """Has a worker call something, again if the worker dies."""

    @abstractmethod
    def explained(self, error: Exception) -> Exception:
        """What the exception of a future means.

        WorkerLost if it is no fault of the call, else what the call raised.
        """

    @abstractmethod
    def cancel(self) -> None:
        """Gives up everything that was submitted."""

    @abstractmethod
    def close(self) -> None:
        """Disconnects."""


class ClusterBackend(Backend):
    """The workers of a cluster, all of them.

    Args:
        cluster: A connection, which the backend will close.
    """

    def __init__(self, cluster: Cluster) -> None:
        self._cluster = cluster

    def map(
        self, work: Callable[[Item], Outcome], items: Sequence[Item]
    ) -> Generator[Outcome, None, None]:
        """See Backend.

        Raises:
            UsageError: A worker has not what it needs to give the bytes that this process would.
        """
        if not items:
            return
        # All at once: the cluster knows best how many workers it has, or can get, for them.
        parallel = Parallel(
            backend=_Futures(self._cluster),
            return_as="generator_unordered",
            batch_size=1,
            pre_dispatch="all",
        )
        elsewhere = Elsewhere(work, versions())
        yield from closed_quietly(parallel(delayed(elsewhere)(item) for item in items))

    def close(self) -> None:
        """Disconnects."""
        self._cluster.close()


class Elsewhere(Generic[Item, Outcome]):
    """Work in a process of a cluster.

    One item at a time, also where a process has several threads for work: Python would run only one
    of them anyway.

    Args:
        work: What to do.
        expected: The versions that it has to be done with.
    """

    def __init__(self, work: Callable[[Item], Outcome], expected: Mapping[str, str]) -> None:
        self._work = work
        self._expected = expected

    def __call__(self, item: Item) -> Outcome:
        """Does the work.

        Raises:
            UsageError: Versions differ.
        """
        differs = difference(versions(), self._expected)
        if differs is not None:
            message = (
                f"a worker of the cluster has {differs}; results could differ, install the same there"
            )
            raise UsageError(message)
        with _busy:
            return self._work(item)


class _Futures(ParallelBackendBase):  # type: ignore[misc] # joblib has no type information
    """A cluster as joblib sees it.

    Not the backends that Ray and joblib bring for it: Ray's gives nothing before all is done, and
    neither tells of a lost worker.
    """

    supports_retrieve_callback = True
    default_n_jobs = -1

    def __init__(self, cluster: Cluster) -> None:
        super().__init__()
        self._cluster = cluster

    def effective_n_jobs(self, n_jobs: int) -> int:  # noqa: ARG002 - joblib's signature
        return 2  # if it were told of one, joblib would work in this process

    def submit(
        self, func: Callable[[], Any], callback: Callable[["Future[Any]"], None]
    ) -> "Future[Any]":
        future = self._cluster.submit(_by_value(func))
        future.add_done_callback(callback)
        return future

    def retrieve_result_callback(self, out: "Future[Any]") -> Any:  # noqa: ANN401 - whatever was called
        try:
            return out.result()
        except Exception as error:
            explained = self._cluster.explained(error)
            if isinstance(explained, ImportError):
                message = (
                    f"a worker of the cluster cannot load its work ({explained}); "
                    f"install rover-harness[tune] {__version__} for all workers"
                )
                raise UsageError(message) from error
            raise explained from error

    def abort_everything(self, ensure_ready: bool = True) -> None:  # noqa: ARG002 - as above
        self._cluster.cancel()


def _by_value(call: Callable[[], Any]) -> Callable[[], Any]:
    """A call that arrives also where this package is missing, and tells so there.

    Ray and Dask send a nested function by value; Dask's scheduler, too, would have to load any other.
    """
    content = pickle.dumps(call)

    def load_and_call() -> Any:  # noqa: ANN401 - whatever is called
        try:
            loaded = pickle.loads(content)  # noqa: S301 - our own, see above
        except (ImportError, AttributeError) as error:
            raise ImportError(str(error)) from error
        return loaded()

    return load_and_call
