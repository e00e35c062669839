"""Workers of a Ray or Dask cluster that the user already has; it gives a dead worker's calls to others.

joblib's own backends for them are not used: Ray's gives nothing before all is done and loses a killed
worker's calls; Dask's calls in this process, unasked, while the cluster has a single worker.
"""

import logging
import pickle
import platform
import re
import signal
import socket
import subprocess
import sys
import threading
import traceback
import warnings
import zlib
from abc import abstractmethod
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future, as_completed
from functools import cache
from importlib import import_module
from typing import Any, ClassVar

from harness.base.errors import UsageError
from harness.base.interrupt import HANDLED
from harness.base.version import __version__, packages
from harness.base.workers.pool import Item, Outcome, WorkerLost, Workers

ADDRESS = re.compile(r"(\w+://)?([^/\s]+):(\d+)|auto")  # "auto" is looked up by Ray's client
CONNECTION, PATIENCE = 3.0, 20.0  # [s] for a connection; for an answer, also on a busy machine

_busy = threading.Lock()


class Cluster(Workers):
    """A cluster, all its workers, connected.

    Raises:
        UsageError: Nothing answers at the address, or the cluster has no worker.
    """

    name: ClassVar[str]  # in messages
    trial: ClassVar[str]  # Python that connects to sys.argv[1] and prints the number of workers
    start: ClassVar[str]  # shell commands that start one

    def __init__(self, address: str) -> None:
        mend = f"start one with {self.start}, or correct the address, HOST:PORT or a URL"
        parts = ADDRESS.fullmatch(address)
        if parts is None:
            raise UsageError(f"'{address}' is no address of a cluster; {mend}")
        try:
            if parts[2]:
                socket.create_connection((parts[2].strip("[]"), parts[3]), timeout=CONNECTION).close()
            workers = _answer(self.trial, address)
        except (OSError, OverflowError) as error:
            raise UsageError(f"{self.name} does not answer at {address} ({error}); {mend}") from error
        if not workers:
            raise UsageError(f"{self.name} at {address} has no worker; start some")

    @abstractmethod
    def submit(self, call: Callable[[], Any]) -> Future[Any]:
        """Has a worker call something, again if the worker dies."""

    @abstractmethod
    def cancel(self) -> None:
        """Gives up everything that was submitted."""

    def map(
        self, work: Callable[[Item], Outcome], items: Sequence[Item]
    ) -> Generator[Outcome, None, None]:
        """Yields outcomes as Workers.map does; UsageError if a worker would give other bytes."""
        expected = versions()
        try:
            # All at once: the cluster knows best how many workers it has, or can get, for them.
            for future in as_completed([self.submit(_by_value(work, item, expected)) for item in items]):
                yield self._outcome(future)
        finally:
            self.cancel()

    def _outcome(self, future: Future[Any]) -> Any:  # noqa: ANN401 - whatever was worked out
        try:
            outcome, error = future.result()
        except Exception as lost:  # what work raises is returned, see `_by_value`
            why = f"{type(lost).__name__}; out of memory?"
            raise WorkerLost(f"workers of {self.name} were lost ({why})") from lost
        if isinstance(error, ImportError):
            mend = f"install rover-harness[tune] {__version__} for all workers"
            message = f"a worker of {self.name} cannot load its work ({error}); {mend}"
            raise UsageError(message) from error
        if error is not None:
            raise error
        return outcome


class RayWorkers(Cluster):
    """The workers of a Ray cluster."""

    name, start = "the Ray cluster", "`ray start --head`"
    trial = """import ray, sys
ray.init(address=sys.argv[1], logging_level="error", log_to_driver=False)
print(ray.cluster_resources().get("CPU", 0))"""

    def __init__(self, address: str) -> None:
        self._ray = import_module("ray")
        super().__init__(address)
        handlers = {number: signal.getsignal(number) for number in HANDLED}
        try:
            self._ray.init(address=address, logging_level=logging.ERROR, log_to_driver=False)
        finally:  # Ray takes SIGTERM for itself; commands of this project answer it in their own way
            for number, handler in handlers.items():
                signal.signal(number, handler)
        self._call = self._ray.remote(lambda call: call())
        self._submitted: list[Any] = []

    def submit(self, call: Callable[[], Any]) -> Future[Any]:
        """Makes a task of a call."""
        if not self._ray.is_initialized():  # the call would start a cluster on this machine, unasked
            raise WorkerLost(f"{self.name} is gone")
        self._submitted.append(self._call.remote(call))
        future: Future[Any] = self._submitted[-1].future()
        return future

    def cancel(self) -> None:
        """Gives up every task."""
        if self._ray.is_initialized():  # or this would start one
            for reference in self._submitted:
                self._ray.cancel(reference, force=True)
        self._submitted.clear()

    def __exit__(self, *_: object) -> None:
        self._ray.shutdown()


class DaskWorkers(Cluster):
    """The workers of a Dask cluster."""

    name, start = "the Dask cluster", "`dask scheduler` and `dask worker`"
    trial = """import sys; from distributed import Client
with Client(sys.argv[1], set_as_default=False) as client:
    print(len(client.nthreads()))"""

    def __init__(self, address: str) -> None:
        connect = import_module("distributed").Client
        super().__init__(address)
        # It logs what it retries; what matters comes as an exception.
        for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
            logging.getLogger(name).setLevel(logging.CRITICAL)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about versions: each worker compares those that matter
            self._client = connect(address, set_as_default=False)
        self._executor = self._client.get_executor(pure=False)

    def submit(self, call: Callable[[], Any]) -> Future[Any]:
        """Makes a task of a call."""
        if self._client.status != "running":
            raise WorkerLost(f"{self.name} is gone")
        future: Future[Any] = self._executor.submit(call)
        return future

    def cancel(self) -> None:
        """Gives up every task."""
        if self._client.status == "running":
            self._executor.shutdown(wait=False)
            self._executor = self._client.get_executor(pure=False)

    def __exit__(self, *_: object) -> None:
        self._client.close()


def _answer(code: str, address: str) -> float:
    """What a program prints last, in a process that can be given up, as the clients cannot."""
    words = [sys.executable, "-c", code, address]  # Ray's and Dask's retry for minutes, or crash
    try:
        tried = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, check=False)
        return float(tried.stdout.split()[-1])
    except subprocess.TimeoutExpired as error:
        raise TimeoutError(f"nothing within {PATIENCE:g} s") from error
    except (IndexError, ValueError) as error:
        lines = tried.stderr.strip().splitlines() or ["it ended silently"]
        raise ConnectionError(lines[-1]) from error


def _by_value(
    work: Callable[[Item], Outcome], item: Item, expected: Mapping[str, str]
) -> Callable[[], Any]:
    """Returns a call that gives an outcome and None, or None and the exception, on any worker."""
    content = pickle.dumps((_work_elsewhere, work, item, expected))
    # A nested function is sent by value, so it arrives also where this package is missing; Dask's
    # scheduler, too, would have to load any other.

    def load_and_call() -> tuple[Any, Exception | None]:
        try:
            function, *arguments = pickle.loads(content)  # noqa: S301 - our own
        except (ImportError, AttributeError) as error:
            return None, ImportError(str(error))
        outcome: tuple[Any, Exception | None] = function(*arguments)
        return outcome

    return load_and_call


def _work_elsewhere(
    work: Callable[[Item], Outcome], item: Item, expected: Mapping[str, str]
) -> tuple[Outcome | None, Exception | None]:
    """Works on an item in a process of a cluster, if its versions give the same bytes."""
    here = versions()
    differ = [f"{name} {here[name]} instead of {e}" for name, e in expected.items() if here[name] != e]
    if differ:
        mend = "results could differ, install the same there"
        return None, UsageError(f"a worker of the cluster has {', '.join(differ)}; {mend}")
    try:
        with _busy:  # one item at a time: of several threads Python would run only one anyway
            return work(item), None
    except Exception as error:  # noqa: BLE001 - raised where the outcome is awaited
        error.add_note(traceback.format_exc())
        return None, error


@cache
def versions() -> Mapping[str, str]:
    """Returns the versions of this process that its bytes depend on, by name."""
    return {
        "rover-harness": __version__,
        "Python": ".".join(platform.python_version_tuple()[:2]),
        "CPU": platform.machine(),
        "zlib": zlib.ZLIB_RUNTIME_VERSION,
        **packages(),
    }
