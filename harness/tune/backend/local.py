"""Processes of this machine: joblib's loky."""

import os
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager

from joblib import Parallel, cpu_count, delayed, parallel_config
from joblib.externals.loky import get_reusable_executor

from harness.base.interrupt import FROM_TERMINALS, held_back
from harness.tune.backend.base import Backend, Item, Outcome, WorkerLost

WARNINGS = "PYTHONWARNINGS"
WATCH = 1.0  # [s] between two looks at whether the process that gives work is still there


class LocalBackend(Backend):
    """Local processes, one per usable CPU if `jobs` is None; with one job, this process itself."""

    def __init__(self, jobs: int | None) -> None:
        self.jobs = jobs or cpu_count()

    def map(
        self, work: Callable[[Item], Outcome], items: Sequence[Item]
    ) -> Generator[Outcome, None, None]:
        """See Backend."""
        if not items:
            return
        # One thread each: numerical libraries would start one per CPU in every process.
        with parallel_config(
            "loky", inner_max_num_threads=1, initializer=_leave_with, initargs=(os.getpid(),)
        ):
            parallel = Parallel(n_jobs=self.jobs, return_as="generator_unordered", batch_size=1)
        with _quiet_children():
            outcomes = parallel(delayed(work)(item) for item in items)
        try:
            # No `yield from`: it would close joblib's generator before its warning is off.
            for outcome in outcomes:  # noqa: UP028 - see above
                yield outcome
        except BrokenExecutor as error:
            raise WorkerLost("a worker process was killed (out of memory?)") from error
        finally:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # that work is thrown away
                outcomes.close()
            if self.jobs > 1:  # joblib would keep the processes for the next work
                get_reusable_executor(reuse=True).shutdown(kill_workers=True)


@contextmanager
def _quiet_children() -> Iterator[None]:
    """Processes that start within leave Ctrl-C to this one, and loky's keeper of semaphores is silent.

    So does the thread that starts them anew. The keeper cleans up what an executor had no time to,
    which is its purpose and no news.
    """
    filters = os.environ.get(WARNINGS)
    os.environ[WARNINGS] = ",".join(filter(None, (filters, "ignore:resource_tracker:UserWarning")))
    try:
        with held_back(FROM_TERMINALS):
            yield
    finally:
        os.environ.pop(WARNINGS)
        if filters is not None:
            os.environ[WARNINGS] = filters


def _leave_with(parent: int) -> None:
    """In a worker: ends it with the process that started it, even if that was killed."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(WATCH)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
