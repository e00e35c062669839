"""Tells when something that should go on has stopped, and when it goes on again."""

from typing import NamedTuple

LONGEST_LOOK = 2_000_000_000  # ns; a clock that jumps an hour makes no hour of silence


class Silence(NamedTuple):
    """A silence that has just been noticed, or has just ended."""

    is_over: bool
    seconds: float


class SilenceWatch:
    """Watches a count, or anything else that differs each time one looks unless it has stopped.

    Time is what passes between two looks, so a clock that is reset or jumps does no harm.

    Attributes:
        is_silent: Whether a silence has been noticed that is not over.
    """

    def __init__(self) -> None:
        self._progress: int | None = None
        self._looked_ns = 0
        self._quiet_ns = 0
        self.is_silent = False

    def look(self, progress: int, now_ns: int, limit_ns: int) -> Silence | None:
        """Looks again.

        Args:
            progress: The count as it is now.
            now_ns: The time [ns].
            limit_ns: From which duration on a silence is told [ns]; 0 is never.

        Returns:
            What has changed: a silence that is long enough now or that is over; else None.
        """
        passed = min(max(now_ns - self._looked_ns, 0), LONGEST_LOOK)
        moved = progress != self._progress
        self._progress, self._looked_ns = progress, now_ns
        quiet_ns = self._quiet_ns + passed
        self._quiet_ns = 0 if moved else quiet_ns
        if moved:
            was_silent, self.is_silent = self.is_silent, False
            return Silence(is_over=True, seconds=quiet_ns / 1e9) if was_silent else None
        if not self.is_silent and 0 < limit_ns <= quiet_ns:
            self.is_silent = True
            return Silence(is_over=False, seconds=quiet_ns / 1e9)
        return None
