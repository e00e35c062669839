"""Workers of a cluster that the user already has: what Ray and Dask have in common."""

import pickle
import platform
import threading
import zlib
from abc import abstractmethod
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future, as_completed
from functools import cache
from importlib.metadata import version
from typing import Any

from harness import __version__
from harness.base.errors import UsageError
from harness.tune.backend.base import Backend, Item, Outcome

PACKAGES = ("mujoco", "numba", "numpy", "scipy")

_busy = threading.Lock()


class ClusterBackend(Backend):
    """The workers of a cluster, all of them; it gives a dead worker's calls to others by itself.

    Not joblib's backends for Ray and Dask: Ray's gives nothing before all is done, and neither tells of
    a lost worker.
    """

    def map(
        self, work: Callable[[Item], Outcome], items: Sequence[Item]
    ) -> Generator[Outcome, None, None]:
        """See Backend.

        Raises:
            UsageError: A worker has not what it needs to give the bytes that this process would.
        """
        expected = versions()
        try:
            # All at once: the cluster knows best how many workers it has, or can get, for them.
            for future in as_completed([self.call(_by_value(work, item, expected)) for item in items]):
                yield self._outcome(future)
        finally:
            self.cancel()

    @abstractmethod
    def call(self, function: Callable[[], Any]) -> Future[Any]:
        """Has a worker call something, again if the worker dies."""

    @abstractmethod
    def explained(self, error: Exception) -> Exception:
        """Returns what the exception of a future means: WorkerLost if it is no fault of the call."""

    @abstractmethod
    def cancel(self) -> None:
        """Gives up everything that was submitted."""

    def _outcome(self, future: Future[Any]) -> Any:  # noqa: ANN401 - whatever was called
        try:
            return future.result()
        except Exception as error:
            explained = self.explained(error)
            if isinstance(explained, ImportError):
                raise UsageError(
                    f"a worker of the cluster cannot load its work ({explained}); "
                    f"install rover-harness[tune] {__version__} for all workers"
                ) from error
            raise explained from error


def _work_elsewhere(work: Callable[[Item], Outcome], item: Item, expected: Mapping[str, str]) -> Outcome:
    """In a process of a cluster: works on an item, if the versions are those that give the same bytes.

    One item at a time, also where a process has several threads for work: Python would run only one
    of them anyway.
    """
    here = versions()
    differ = [f"{name} {here[name]} instead of {e}" for name, e in expected.items() if here[name] != e]
    if differ:
        raise UsageError(
            f"a worker of the cluster has {', '.join(differ)}; results could differ, "
            "install the same there"
        )
    with _busy:
        return work(item)


@cache
def versions() -> Mapping[str, str]:
    """Returns the versions of this process that its bytes depend on, by name."""
    return {
        "rover-harness": __version__,
        "Python": ".".join(platform.python_version_tuple()[:2]),
        "CPU": platform.machine(),
        "zlib": zlib.ZLIB_RUNTIME_VERSION,
        **{package: version(package) for package in PACKAGES},
    }


def _by_value(*arguments: object) -> Callable[[], Any]:
    """A call of `_work_elsewhere` that arrives also where this package is missing, and tells so there.

    Ray and Dask send a nested function by value; Dask's scheduler, too, would have to load any other.
    """
    content = pickle.dumps((_work_elsewhere, arguments))

    def load_and_call() -> Any:  # noqa: ANN401 - whatever is called
        try:
            function, loaded = pickle.loads(content)  # noqa: S301 - our own, see above
        except (ImportError, AttributeError) as error:
            raise ImportError(str(error)) from error
        return function(*loaded)

    return load_and_call
