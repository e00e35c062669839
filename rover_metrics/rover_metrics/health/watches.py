"""Watches: whether what should go on has stopped or goes on again, and what a topic's stamps tell."""

import math
from collections import deque
from statistics import median
from typing import NamedTuple

LONGEST_LOOK = 2_000_000_000  # ns; a clock that jumps an hour makes no hour of silence
JUMP = 10_000_000_000  # ns; a longer step is another time, not a row of lost messages
LEARNING = 8  # intervals from which a period can be estimated
RECENT = 64  # intervals
GAP = 1.7  # periods; stamps jitter, and a missing message makes two

NO_STAMP = "no stamp"
STANDS_STILL = "stamp stands still"
WENT_BACK = "stamp went back"
JUMPED_AHEAD = "stamp jumped ahead"
MISSING = "missing, by the gap between two stamps"

Finding = tuple[str, int]  # what is odd, and how many times


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
        """Looks again; returns a silence that is long enough now or that is over, else None.

        Args:
            progress: The count as it is now.
            now_ns: The time [ns].
            limit_ns: From which duration on a silence is reported [ns]; 0 is never.
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


class StampWatch:
    """Judges each stamp by the one before it; `period_ns` is None until enough have come."""

    def __init__(self) -> None:
        self.period_ns: float | None = None
        self._last: int | None = None
        self._intervals: deque[int] = deque(maxlen=RECENT)
        self._longest: float = JUMP

    @property
    def latest_ns(self) -> int:
        """The latest stamp [ns]; 0 before the first."""
        return self._last or 0

    def take(self, stamp_ns: int) -> Finding | None:
        """Takes the stamp of the next message [ns]; returns what is odd about it."""
        last, self._last = self._last, stamp_ns
        if last is None:
            return None if stamp_ns else (NO_STAMP, 1)
        interval = stamp_ns - last
        if 0 < interval <= self._longest:
            self._intervals.append(interval)
            return None
        return self._oddity(stamp_ns, interval)

    def learn(self) -> None:
        """Takes the median of the recent intervals for the period; to be called now and then."""
        if len(self._intervals) >= LEARNING:
            self.period_ns = median(self._intervals)
            self._longest = min(GAP * self.period_ns, JUMP)

    def _oddity(self, stamp_ns: int, interval: int) -> Finding:
        if interval == 0:
            return (STANDS_STILL if stamp_ns else NO_STAMP), 1
        if interval < 0:
            return WENT_BACK, 1
        if interval > JUMP or self.period_ns is None:
            return JUMPED_AHEAD, 1
        self._intervals.append(interval)  # so that a slower sensor is soon nothing odd any more
        return MISSING, math.floor(interval / self.period_ns + 0.5) - 1
