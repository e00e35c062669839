"""What a cluster does with work, on a stand-in with threads for workers."""

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from types import ModuleType
from typing import Any

import pytest

from harness.base.errors import UsageError
from harness.tune.backend import WorkerLost
from harness.tune.backend.cluster import ClusterBackend, _work_elsewhere, versions


class Threads(ClusterBackend):
    """A cluster of one worker with one thread."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="worker")
        self.futures: list[Future[Any]] = []
        self.cancelled = 0

    def call(self, function: Callable[[], Any]) -> "Future[Any]":
        self.futures.append(self._pool.submit(function))
        return self.futures[-1]

    def explained(self, error: Exception) -> Exception:
        return WorkerLost("gone") if isinstance(error, MemoryError) else error

    def cancel(self) -> None:
        self.cancelled += 1

    def __exit__(self, *_: object) -> None:
        self._pool.shutdown(cancel_futures=True)


@pytest.fixture
def threads() -> Iterator[Threads]:
    with Threads() as threads:
        yield threads


def thread_name(_: int) -> str:
    return threading.current_thread().name


def run_out_of_memory(_: int) -> None:
    raise MemoryError


def test_all_work_is_submitted_at_once_and_done_elsewhere(threads: Threads) -> None:
    outcomes = threads.map(thread_name, range(9))

    assert next(outcomes) == "worker_0"
    assert len(threads.futures) == 9
    assert list(outcomes) == ["worker_0"] * 8
    assert list(threads.map(thread_name, [])) == []


def test_a_lost_worker_is_told_and_the_rest_given_up(threads: Threads) -> None:
    with pytest.raises(WorkerLost, match="gone"):
        list(threads.map(run_out_of_memory, range(3)))

    assert threads.cancelled == 1


def test_closing_early_gives_up_the_rest(threads: Threads) -> None:
    outcomes = threads.map(thread_name, range(9))
    next(outcomes)
    outcomes.close()

    assert threads.cancelled == 1


def test_a_worker_without_this_package_is_told(
    threads: Threads, stand_ins: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    def load_nothing(_: bytes) -> None:
        raise ModuleNotFoundError("No module named 'harness'")

    monkeypatch.setattr("harness.tune.backend.cluster.pickle.loads", load_nothing)
    with pytest.raises(UsageError, match=r"No module named 'harness'.*install rover-harness\[tune\]"):
        list(threads.map(stand_ins.square, range(2)))


def test_a_worker_with_another_version_is_refused() -> None:
    expected = {**versions(), "numpy": "1.0"}

    with pytest.raises(UsageError, match=r"a worker of the cluster has numpy \S+ instead of 1\.0; "):
        _work_elsewhere(thread_name, 0, expected)


def test_a_process_does_one_thing_at_a_time() -> None:
    met = threading.Barrier(2, timeout=0.2)

    def meet(_: int) -> None:
        met.wait()

    with ThreadPoolExecutor(2) as pool:
        futures = [pool.submit(_work_elsewhere, meet, n, versions()) for n in range(2)]
        errors = [future.exception() for future in futures]

    assert all(isinstance(error, threading.BrokenBarrierError) for error in errors)
