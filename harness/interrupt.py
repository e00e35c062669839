"""Ctrl-C and SIGTERM: at once while a run starts, between two batches while it drives.

A run that drives must neither tear a row nor lose its summary, so its loop asks for the request. While
worlds are built and nodes are searched for, there is nothing to lose and the signal ends the command.
"""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any, Self

from harness.errors import HarnessError

HANDLED = (signal.SIGINT, signal.SIGTERM)


class Interrupted(HarnessError):
    """Somebody stopped the command by a signal; the exit code is 128 + its number, as in a shell."""

    def __init__(self, number: signal.Signals) -> None:
        super().__init__(f"stopped by {number.name}")
        self.exit_code = 128 + number


class StopRequest:
    """Turns the first SIGINT or SIGTERM into a request where `deferred` is entered.

    Attributes:
        signal: The signal that asked for the stop, or None.
    """

    def __init__(self) -> None:
        self.signal: signal.Signals | None = None
        self._deferring = False
        self._previous: dict[signal.Signals, Any] = {}

    def __enter__(self) -> Self:
        self._previous = {number: signal.signal(number, self._handle) for number in HANDLED}
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)

    @contextmanager
    def deferred(self) -> Iterator[None]:
        """Within, the first signal is only remembered; a second one still ends the command."""
        self._deferring = True
        try:
            yield
        finally:
            self._deferring = False

    @property
    def exit_code(self) -> int:
        """0 without a request."""
        return 0 if self.signal is None else Interrupted(self.signal).exit_code

    def _handle(self, number: int, _: FrameType | None) -> None:
        again = self.signal is not None
        self.signal = signal.Signals(number)
        if again or not self._deferring:
            raise Interrupted(self.signal)
