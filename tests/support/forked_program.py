"""Programs forked from a process that has imported all they need: an interpreter alone takes 1.3 s.

They share nothing with the tests' process, so they do what programs of `python -m` do, which
tests/e2e/test_two_processes.py starts, lets drive and stops with Ctrl-C.
"""

import fcntl
import importlib
import multiprocessing
import os
import signal
import subprocess
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

from tests.support.forking import ForkServer


class ForkedProgram:
    """As `subprocess.Popen` of `python -m PROGRAM WORDS...` in a session of its own, gone when left.

    Args:
        program: The module, or a function that takes the words and returns an exit code.
        words: Its arguments.
        said: File for what it says, or a terminal, which becomes its own.
        env: Its environment; as it is here if None.
        cwd: Its current folder; as it is here if None.
    """

    def __init__(
        self,
        program: str | Callable[[list[str]], int],
        words: Sequence[str],
        said: Path | str = os.devnull,
        *,
        env: Mapping[str, str] | None = None,
        cwd: Path | None = None,
    ) -> None:
        context = ForkServer().get_context("spawn")
        ready, remote = context.Pipe(duplex=False)
        inherited = _Inherited(
            environment=dict(os.environ if env is None else env),
            folder=str(cwd or Path.cwd()),
            cores=os.sched_getaffinity(0),
        )
        self._process = context.Process(
            target=_begin, args=(program, [*words], str(said), inherited, remote)
        )
        self._process.start()
        remote.close()
        ready.recv()  # else a signal would meet an interpreter that is no program yet
        ready.close()
        assert self._process.pid is not None
        self.said, self.pid = Path(said), self._process.pid

    def __enter__(self) -> "ForkedProgram":
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()
        self._process.join()

    @property
    def returncode(self) -> int | None:
        """None as long as it runs."""
        return self._process.exitcode

    def poll(self) -> int | None:
        """The exit code, if it has ended."""
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """The exit code, once it has ended."""
        self._process.join(timeout)
        if self.returncode is None:
            raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
        return self.returncode

    def finished(self, timeout: float) -> str:
        """All that it has said, once it has ended."""
        self.wait(timeout)
        return self.said.read_text()

    def send_signal(self, number: int) -> None:
        """To this process alone, if it runs."""
        if self.returncode is None:
            with suppress(ProcessLookupError):  # the fork server has seen its end before this process
                os.kill(self.pid, number)

    def terminate(self) -> None:
        """Asks it to end."""
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        """Makes it end."""
        self.send_signal(signal.SIGKILL)


@dataclass(frozen=True)
class _Inherited:
    """What a program has from whoever starts it, not from the fork server."""

    environment: dict[str, str]
    folder: str
    cores: set[int]


def _begin(
    program: str | Callable[[list[str]], int],
    words: list[str],
    said: str,
    inherited: _Inherited,
    ready: Connection,
) -> None:
    os.setsid()
    parent = multiprocessing.parent_process()
    assert parent is not None
    # Else it would outlive tests that are killed, and publish in a domain that is free again.
    fcntl.fcntl(parent.sentinel, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(parent.sentinel, fcntl.F_SETSIG, signal.SIGKILL)
    fcntl.fcntl(parent.sentinel, fcntl.F_SETFL, os.O_ASYNC)
    output = os.open(said, os.O_RDWR | os.O_CREAT | os.O_TRUNC)  # a terminal is now this session's
    for number in (1, 2):
        os.dup2(output, number)
    os.environ.clear()
    os.environ.update(inherited.environment)
    os.chdir(inherited.folder)
    os.sched_setaffinity(0, inherited.cores)
    main = importlib.import_module(program).main if isinstance(program, str) else program
    if isinstance(program, str) and program.startswith("harness."):
        importlib.import_module("harness.base.edge").begin_program(program)
    ready.send(None)
    ready.close()
    raise SystemExit(main(words))
