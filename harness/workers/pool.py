"""Work on many items, in any order; what a lost worker has not done is done again.

The processes of this machine are those of joblib's loky.
"""

import multiprocessing
import os
import signal
import sys
import threading
import time
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import closing, contextmanager
from functools import partial
from types import FrameType
from typing import Self, TypeVar

from harness.base.errors import RunFailed
from harness.base.interrupt import FROM_TERMINALS, HANDLED, NAP, held_back

Key = TypeVar("Key")
Item = TypeVar("Item")
Outcome = TypeVar("Outcome")

TRIES = 3  # in a row in which workers die before a single outcome has come
NAMED = 3  # items that a message names
# A process that ends at a signal may leave one of joblib's semaphores to its tracker, which warns of it.
TIDIED = "ignore::UserWarning:joblib.externals.loky.backend.resource_tracker"
FAREWELL = 3.0  # [s] for workers to tidy up what they are doing before they are killed
WATCH = 1.0  # [s] between two looks at whether the process that gives work is still there


class WorkerLost(Exception):
    """A worker died; what it was doing has to be done again."""


class _Leaving(BaseException):
    """A worker has been told to end."""


class Workers(ABC):
    """Workers in other processes; a context that lets go of them."""

    @abstractmethod
    def map(
        self, work: Callable[[Item], Outcome], items: Sequence[Item]
    ) -> Generator[Outcome, None, None]:
        """Yields the outcomes of all items, each once, as soon as they are there.

        Closing the generator gives up what is not done.

        Raises:
            WorkerLost: A worker died; items whose outcome has not come may be given again.
        """

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:  # noqa: B027 - processes of this machine live no longer than `map`
        """Lets go of the workers."""


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
            outcomes = parallel(delayed(_worked)(work, item) for item in items)
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
    workers = [one for one in multiprocessing.active_children() if type(one).__name__ == "LokyProcess"]
    for worker in workers:
        worker.terminate()
    end = time.monotonic() + FAREWELL
    for worker in workers:
        worker.join(max(0.0, end - time.monotonic()))


def work_off(
    items: Mapping[Key, Item],
    work: Callable[[Item], Outcome],
    workers: Workers,
    keep: Callable[[Key, Outcome], None],
    *,
    name: Callable[[Key], str],
    mend: str,
) -> None:
    """Has all items worked on; what a worker that dies has not done is given again.

    Args:
        items: By what they are known by.
        work: Makes an outcome of an item, in a worker.
        workers: Who works.
        keep: Takes each outcome as soon as it is there.
        name: Of an item, in messages.
        mend: What a user can do when all workers are lost.

    Raises:
        RunFailed: Workers died again and again.
    """
    left, fruitless = dict(items), 0
    while left:
        before = len(left)
        try:
            with closing(workers.map(partial(_keyed, work), list(left.items()))) as outcomes:
                for key, outcome in outcomes:
                    keep(key, outcome)
                    del left[key]
        except WorkerLost as error:
            fruitless = fruitless + 1 if len(left) == before else 0
            if fruitless == TRIES:
                names = [*map(name, left)]
                more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
                undone = ", ".join(names[:NAMED]) + more
                raise RunFailed(f"{error}; not done: {undone}; {mend}") from error


def _keyed(work: Callable[[Item], Outcome], item: tuple[Key, Item]) -> tuple[Key, Outcome]:
    return item[0], work(item[1])
