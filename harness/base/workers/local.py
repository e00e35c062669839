"""Workers that are processes of this machine, those of joblib's loky, and how signals end them."""

import gc
import multiprocessing
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager
from functools import cache
from types import FrameType

from harness.base.interrupt import FROM_TERMINALS, HANDLED, NAP, held_back
from harness.base.workers.pool import Item, Outcome, WorkerLost, Workers

# A process that ends at a signal may leave one of joblib's semaphores to its tracker, which warns of it.
TIDIED = "ignore::UserWarning:joblib.externals.loky.backend.resource_tracker"
FAREWELL = 3.0  # [s] for workers to tidy up what they are doing before they are killed
WATCH = 1.0  # [s] between two looks at whether the process that gives work is still there


class _Leaving(BaseException):
    """A worker has been told to end."""


class LocalWorkers(Workers):
    """Processes of this machine, one per usable CPU if `jobs` is None; with one job, this one itself."""

    def __init__(self, jobs: int | None) -> None:
        from joblib import cpu_count  # noqa: PLC0415 - --help does without joblib

        self.jobs = jobs or cpu_count()

    def map(
        self, work: Callable[[Item], Outcome], items: Sequence[Item]
    ) -> Generator[Outcome, None, None]:
        """Yields outcomes as Workers.map does, from processes that leave Ctrl-C to this one."""
        from joblib import Parallel, delayed, parallel_config  # noqa: PLC0415
        from joblib.externals.loky import get_reusable_executor  # noqa: PLC0415

        if TIDIED not in sys.warnoptions:  # which Python passes on to the processes that it starts
            sys.warnoptions.append(TIDIED)
        # One thread each: numerical libraries would start one per CPU in every process.
        initargs = (os.getpid(),)
        with (
            parallel_config("loky", inner_max_num_threads=1, initializer=_begin, initargs=initargs),
            held_back(FROM_TERMINALS),
        ):
            parallel = Parallel(n_jobs=self.jobs, return_as="generator_unordered", batch_size=1)
            worked = _worked if self.jobs == 1 else _worked_aside
            outcomes = parallel(delayed(worked)(work, item) for item in items)
        try:
            # No `yield from`: it would close joblib's generator before its warning is off.
            with _ended_by_signals():
                for outcome in outcomes:  # noqa: UP028 - not `yield from`
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
    """Makes a worker end with the process that started it, even if that was killed."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(WATCH)
        os._exit(1)

    def leave(_: int, frame: FrameType | None) -> None:
        while frame is not None and frame.f_code is not _worked.__code__:
            if frame.f_code.co_name == "__del__":  # Python would drop what is raised there
                signal.setitimer(signal.ITIMER_REAL, NAP)
                return
            frame = frame.f_back
        if frame is None:
            os._exit(1)  # no work
        raise _Leaving

    if hasattr(signal, "SIGALRM"):
        signal.signal(signal.SIGALRM, leave)
        signal.signal(signal.SIGTERM, leave)
    threading.Thread(target=watch, daemon=True).start()


def _worked(work: Callable[[Item], Outcome], item: Item) -> Outcome:
    try:
        return work(item)
    except _Leaving:
        os._exit(1)


def _worked_aside(work: Callable[[Item], Outcome], item: Item) -> Outcome:
    """Does work in a process of its own."""
    try:
        return _worked(work, item)
    finally:
        _keep_what_is_loaded()


@cache  # once in a process; to ask the collector whether it was takes 10 ms
def _keep_what_is_loaded() -> None:
    """Keeps what the first work has loaded out of every garbage collection, as `edge.loading` does.

    One of them takes 50 ms, and joblib has it done every second where psutil is missing.
    """
    gc.collect()
    gc.freeze()


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Within, a signal ends the workers before it raises; joblib, which sees that, kills them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    present = {number: signal.getsignal(number) for number in HANDLED}
    handlers = {number: handler for number, handler in present.items() if callable(handler)}

    def end(number: int, frame: FrameType | None) -> None:
        _end_processes()
        handlers[signal.Signals(number)](number, frame)

    for number in handlers:
        signal.signal(number, end)
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)


def _end_processes() -> None:
    """Lets workers end what they do: killed, they leave folders behind, and files of DDS."""
    from joblib.externals.loky.backend.process import LokyProcess  # noqa: PLC0415

    workers = [child for child in multiprocessing.active_children() if isinstance(child, LokyProcess)]
    for worker in workers:
        worker.terminate()
    end = time.monotonic() + FAREWELL
    for worker in workers:
        worker.join(max(0.0, end - time.monotonic()))
