"""The header stamps of one topic: whether they go on as they should, and what is missing between."""

import math
from collections import deque
from statistics import median

JUMP = 10_000_000_000  # ns; a longer step is another time, not a row of lost messages
LEARNING = 8  # intervals from which a period can be told
RECENT = 64  # intervals
GAP = 1.7  # periods; stamps jitter, and a missing message makes two

NO_STAMP = "no stamp"
STANDS_STILL = "stamp stands still"
WENT_BACK = "stamp went back"
JUMPED_AHEAD = "stamp jumped ahead"
MISSING = "missing, by the gap between two stamps"

Finding = tuple[str, int]  # what is odd, and how many times


class StampWatch:
    """Judges each stamp by the one before it.

    Attributes:
        period_ns: Usual time from one stamp to the next [ns]; None until enough have come.
    """

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
