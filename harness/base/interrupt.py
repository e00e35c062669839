"""Ctrl-C, SIGTERM, a closed terminal: at once while a run starts, between two batches while it drives.

A run that drives must neither tear a row nor lose its summary, so its loop asks for the request. While
worlds are built and nodes are searched for, there is nothing to lose and the signal ends the command.
So does a request that the loop has not answered within GRACE, because a listener hangs; where there
are no alarms (Windows), a second Ctrl-C does.
"""

import os
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import resource_tracker
from types import FrameType
from typing import Any, Self

from harness.base.errors import HarnessError

# Windows knows neither SIGHUP nor alarms nor masks of signals.
HANDLED = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)
FROM_TERMINALS = tuple(number for number in HANDLED if number is not signal.SIGTERM)
HANGUP = "SIGHUP"
GRACE = 0.5  # [s] for a loop that drives to answer a request
ALARMS = 5  # that it is counted by: what falls due while this process is stopped is one, however long
NAP = 0.1  # [s]: how long a sleeper may miss a request
STANDARD_OUTPUTS = (1, 2)


class Interrupted(HarnessError):
    """Somebody stopped the command by a signal; the exit code is 128 + its number, as in a shell."""

    def __init__(self, number: signal.Signals) -> None:
        super().__init__(f"stopped by {number.name}")
        self.signal = number
        self.exit_code = 128 + number


class Overdue(Interrupted):
    """A request that was not answered in time: something that the loop waits for hangs."""


class StopRequest:
    """Turns the first SIGINT, SIGTERM or SIGHUP into a request where `deferred` is entered.

    Attributes:
        signal: The signal that asked for the stop, or None.
    """

    def __init__(self) -> None:
        self.signal: signal.Signals | None = None
        self._deferring = False
        self._alarms_left = ALARMS
        self._raised: Interrupted | None = None
        self._previous: dict[signal.Signals, Any] = {}
        self._terminals: list[int] = []

    def __enter__(self) -> Self:
        self._terminals = [fd for fd in STANDARD_OUTPUTS if os.isatty(fd)]
        for number in HANDLED:
            if number.name == HANGUP and signal.getsignal(number) is signal.SIG_IGN:
                continue  # nohup
            self._previous[number] = signal.signal(number, self._handle)
        return self

    def __exit__(self, _: object, error: BaseException | None, __: object) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)
        # C++ bindings that a handler interrupts may report something else than what it raised.
        if self._raised is not None and isinstance(error, Exception) and error is not self._raised:
            raise self._raised from None

    @contextmanager
    def deferred(self) -> Iterator[None]:
        """Within, the first signal is remembered for GRACE; a second one ends the command at once."""
        self._deferring = True
        try:
            yield
        finally:
            self._deferring = False
            if self.signal is not None:
                _alarm(0.0)

    def sleep(self, seconds: float) -> None:
        """Sleeps, but not on after a request."""
        end = time.monotonic() + seconds
        while self.signal is None and (left := end - time.monotonic()) > 0.0:
            time.sleep(min(left, NAP))

    @property
    def name(self) -> str | None:
        """Name of the signal that asked to stop; None without one."""
        return None if self.signal is None else self.signal.name

    @property
    def exit_code(self) -> int:
        """Exit code of a command that was asked to stop; 0 if it was not."""
        return 0 if self.signal is None else Interrupted(self.signal).exit_code

    def _handle(self, number: int, _: FrameType | None) -> None:
        again = self.signal is not None
        self.signal = signal.Signals(number)
        if self.signal.name == HANGUP:
            _let_go_of(self._terminals)
        if again or not self._deferring:
            self._raised = Interrupted(self.signal)
            raise self._raised
        if hasattr(signal, "SIGALRM"):
            self._previous.setdefault(signal.SIGALRM, signal.signal(signal.SIGALRM, self._expire))
        _alarm(GRACE / ALARMS)

    def _expire(self, _: int, __: FrameType | None) -> None:
        self._alarms_left -= 1
        if self._deferring and self.signal is not None and self._alarms_left <= 0:
            self._raised = Overdue(self.signal)
            raise self._raised


def _alarm(seconds: float) -> None:
    """Sends SIGALRM again and again, for bindings may swallow it; 0 ends that."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, seconds, seconds)


@contextmanager
def held_back(signals: Sequence[signal.Signals] = HANDLED) -> Iterator[None]:
    """Lets processes that start within inherit blocked signals, where there are masks of signals.

    A terminal's signals go to every process in it, but are the parent's to answer; what arrives here
    meanwhile is delivered afterwards.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # Its keeper of semaphores unblocks signals when it starts, so it starts before.
    resource_tracker.ensure_running()
    previous = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, previous)


def _let_go_of(terminals: list[int]) -> None:
    """Points outputs to nowhere: writing to a closed terminal raises."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for fd in terminals:
        os.dup2(nowhere, fd)
    os.close(nowhere)
