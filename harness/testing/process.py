"""Programs that a trial starts, in any language; they end with the trial, and are missed before."""

import os
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path

from harness.base.errors import RunFailed, UsageError

EXIT_PATIENCE = 5.0  # [s] for a process to leave after SIGINT before it is killed
LAST_LINES, LAST_BYTES = 8, 4096  # of its output, for the message that it ended
# What becomes the program: it hears signals that a worker of many blocks, and on Linux the kernel ends
# it with the process that started it, however that ended (PR_SET_PDEATHSIG).
BECOME = """\
import ctypes, os, signal, sys
signal.pthread_sigmask(signal.SIG_SETMASK, [])
signal.signal(signal.SIGINT, signal.SIG_DFL)
if sys.platform == "linux":
    ctypes.CDLL(None).prctl(1, signal.SIGTERM)
if os.getppid() == int(sys.argv[1]):
    os.execvp(sys.argv[2], sys.argv[2:])
"""


class Process:
    """A running program.

    Args:
        command: Its words.
        environment: Its variables; programs beside this Python are found first.
        folder: In which it runs; that of this process if None.
        output: Gets what it says; where this process says it if None.
        may_end: Whether it may end well before the trial does.

    Raises:
        UsageError: There is no such program.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        *,
        folder: Path | None = None,
        output: Path | None = None,
        may_end: bool = False,
    ) -> None:
        self._command, self._output, self._may_end = shlex.join(command), output, may_end
        environment = {**environment, "PATH": _path(environment)}
        self._check_program(command[0], environment["PATH"], folder or Path())
        with ExitStack() as files:
            file = None if output is None else files.enter_context(output.open("wb"))
            self._process = subprocess.Popen(
                [sys.executable, "-I", "-S", "-c", BECOME, str(os.getpid()), *command],
                env=environment,
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=file,
                start_new_session=True,  # a terminal's Ctrl-C is this process's to answer
            )

    def _check_program(self, name: str, path: str, folder: Path) -> None:
        there = (folder / name).is_file() if os.sep in name else shutil.which(name, path=path)
        if not there:
            raise UsageError(
                f"there is no program '{name}' to launch ({self._command}); install it, or give its path"
            )

    def check(self, when: str = "") -> None:
        """Makes sure that it still runs; RunFailed, with what it said last, if it may not have ended."""
        code = self._process.poll()
        if code is None or (code == 0 and self._may_end):
            return
        how = f"with exit code {code}" if code >= 0 else f"by {signal.Signals(-code).name}"
        raise RunFailed("\n".join([f"{self._command} ended {how}{when}", *self.last_lines()]))

    def last_lines(self) -> list[str]:
        """Returns its last lines of output, where these are kept."""
        if self._output is None:
            return []
        text = self._output.read_bytes()[-LAST_BYTES:].decode(errors="replace")
        return [line.rstrip() for line in text.splitlines() if line.strip()][-LAST_LINES:]

    def stop(self) -> None:
        """Ends it and what it has started, as Ctrl-C does, or else by force."""
        try:
            self._signal(signal.SIGINT)
            self._process.wait(EXIT_PATIENCE)
        except subprocess.TimeoutExpired:
            pass
        finally:
            self._signal(signal.SIGKILL)
            self._process.wait()

    def _signal(self, number: signal.Signals) -> None:
        """Signals the whole group, which may outlive the process."""
        with suppress(ProcessLookupError):  # all of it has ended
            os.killpg(self._process.pid, number)


class Programs(ExitStack):
    """The programs that run in a ROS domain; a context that ends them. `when` tells the time."""

    def __init__(self, domain: int, when: Callable[[], str]) -> None:
        super().__init__()
        self._environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
        self._when, self._running = when, list[Process]()

    def begin(
        self,
        command: Sequence[str],
        folder: Path | None = None,
        output: Path | None = None,
        *,
        may_end: bool = False,
    ) -> Process:
        """Starts a Process, which ends with this context.

        Args:
            command: Its words.
            folder: In which it runs; that of this process if None.
            output: Gets what it says; where this process says it if None.
            may_end: Whether it may end well before the trial does.
        """
        process = Process(command, self._environment, folder=folder, output=output, may_end=may_end)
        self.callback(process.stop)
        self._running.append(process)
        return process

    def check(self) -> None:
        """Makes sure that all still run, as `Process.check` does of one."""
        for process in self._running:
            process.check(self._when())

    def told(self, failure: str) -> str:
        """Returns a failure with when it was, and what each program said last."""
        words = [line for process in self._running for line in process.last_lines()]
        return "\n".join([f"{failure}{self._when()}", *words])


def _path(environment: Mapping[str, str]) -> str:
    """Where programs are looked for: first in the virtual environment of this Python."""
    path = environment.get("PATH", os.defpath)
    return path if sys.prefix == sys.base_prefix else os.pathsep.join((f"{sys.prefix}/bin", path))
