"""Jobs in forked processes, each with its own folder for temporary files and ended with its children."""

import contextlib
import ctypes
import os
import shutil
import signal
import tempfile
import traceback
from collections.abc import Callable, Iterable, Iterator
from multiprocessing.connection import Connection, Pipe, wait
from pathlib import Path
from typing import TypeVar

_PR_SET_PDEATHSIG = 1  # Linux: what a child gets when its parent is gone

J = TypeVar("J")
R = TypeVar("R")


def in_forks(
    jobs: Iterable[J], work: Callable[[J], R], *, at_once: int, quiet: bool = True
) -> Iterator[tuple[J, R | None]]:
    """Results in the order in which they come; None for a job that died, also by its time limit.

    Args:
        jobs: What is to be done.
        work: Does it, in a process of its own that is a copy of this one.
        at_once: How many jobs at the same time.
        quiet: Whether what they print is thrown away.

    Raises:
        RuntimeError: A job raised an exception; the text is its trace.
    """
    waiting = iter(jobs)
    running: dict[Connection, tuple[J, int, int, str]] = {}
    try:
        while True:
            while len(running) < at_once:
                try:
                    job = next(waiting)
                except StopIteration:
                    break
                folder = tempfile.mkdtemp(prefix="mutant-")
                ours, theirs = Pipe(duplex=False)
                pid = os.fork()
                if pid == 0:
                    _work(job, work, theirs, folder, quiet=quiet)
                theirs.close()
                running[ours] = job, pid, os.pidfd_open(pid), folder
            if not running:
                return
            # A child's own children may hold its end of the pipe open, so its death is watched as well.
            ready = set(wait([*running, *(watch for _, _, watch, _ in running.values())]))
            for pipe in [pipe for pipe, (_, _, watch, _) in running.items() if ready & {pipe, watch}]:
                job, pid, watch, folder = running.pop(pipe)
                result, complaint = None, ""
                with contextlib.suppress(EOFError):
                    result, complaint = pipe.recv() if pipe.poll() else (None, "")
                _end(pipe, pid, watch, folder)
                if complaint:
                    raise RuntimeError(complaint)
                yield job, result
    finally:
        for pipe, (_, pid, watch, folder) in running.items():
            _end(pipe, pid, watch, folder)


def _work(job: J, work: Callable[[J], R], pipe: Connection, folder: str, *, quiet: bool) -> None:
    """What the child does; it ends here."""
    try:
        os.setsid()
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.environ["TMPDIR"] = os.environ["PYTEST_DEBUG_TEMPROOT"] = folder
        tempfile.tempdir = None
        if quiet:
            nothing = os.open(os.devnull, os.O_RDWR)
            for stream in (0, 1, 2):
                os.dup2(nothing, stream)
        pipe.send((work(job), ""))
    except BaseException:  # noqa: BLE001 - it must not go on as its parent
        pipe.send((None, traceback.format_exc()))
    finally:
        os._exit(0)


def _end(pipe: Connection, pid: int, watch: int, folder: str) -> None:
    for kill in (os.killpg, os.kill):
        with contextlib.suppress(ProcessLookupError):
            kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    os.close(watch)
    pipe.close()
    shutil.rmtree(Path(folder), ignore_errors=True)
