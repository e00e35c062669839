"""Processes of this machine: joblib's loky."""

import os
import sys
import threading
import time
import warnings
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import BrokenExecutor

from joblib import Parallel, cpu_count, delayed, parallel_config
from joblib.externals.loky import get_reusable_executor

from harness.base.interrupt import FROM_TERMINALS, held_back
from harness.workers.pool import Item, Outcome, WorkerLost, Workers

# A process that ends at a signal may leave one of joblib's semaphores to its tracker, which warns of it.
TIDIED = "ignore::UserWarning:joblib.externals.loky.backend.resource_tracker"
WATCH = 1.0  # [s] between two looks at whether the process that gives work is still there


class LocalWorkers(Workers):
    """Local processes, one per usable CPU if `jobs` is None; with one job, this process itself."""

    def __init__(self, jobs: int | None) -> None:
        self.jobs = jobs or cpu_count()

    def map(
        self, work: Callable[[Item], Outcome], items: Sequence[Item]
    ) -> Generator[Outcome, None, None]:
        """Yields outcomes as Workers.map does, from processes that leave Ctrl-C to this one."""
        parent = os.getpid()
        if TIDIED not in sys.warnoptions:  # which Python passes on to the processes that it starts
            sys.warnoptions.append(TIDIED)
        # One thread each: numerical libraries would start one per CPU in every process.
        with (
            parallel_config("loky", inner_max_num_threads=1, initializer=_begin, initargs=(parent,)),
            held_back(FROM_TERMINALS),
        ):
            parallel = Parallel(n_jobs=self.jobs, return_as="generator_unordered", batch_size=1)
            outcomes = parallel(delayed(work)(item) for item in items)
        try:
            # No `yield from`: it would close joblib's generator before its warning is off.
            for outcome in outcomes:  # noqa: UP028 - see above
                yield outcome
        except BrokenExecutor as error:
            raise WorkerLost("a worker of this machine was killed (out of memory?)") from error
        finally:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # that work is thrown away
                outcomes.close()
            if self.jobs > 1:  # joblib would keep the processes for the next work
                get_reusable_executor(reuse=True).shutdown(kill_workers=True)


def _begin(parent: int) -> None:
    """In a worker: ends it with the process that started it, even if that was killed."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(WATCH)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
