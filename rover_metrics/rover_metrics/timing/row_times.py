"""When a row is due: once a period, whatever clock and executor do; and when a new segment begins."""


class RowTimes:
    """Guards the rows of one session against timers that fire twice and clocks that are set.

    A segment ends where time goes back: the simulator was restarted or its clock reset. Executors under
    load fire a timer twice in a row, and two clocks that fight make it fire with every message.

    Args:
        period_ns: Time from row to row [ns].

    Attributes:
        segments: Segments so far, this one included.
        suppressed: Rows that were not due.
    """

    def __init__(self, period_ns: int) -> None:
        self._period = period_ns
        self._last: int | None = None  # time of the latest row
        self._is_new_segment = False  # and time has passed in it without a leap
        self.segments = 1
        self.suppressed = 0

    def went_back(self) -> None:
        """Begin a new segment: the clock has been set back."""
        self.segments += 1
        self._is_new_segment = True

    def leapt_ahead(self) -> None:
        """Take note that the clock has been set ahead: what fires now is no full period."""
        self._is_new_segment = False

    def is_due(self, now_ns: int) -> bool:
        """Tell whether a timer that fires now is to write a row; if so, count on that it does."""
        if self._is_double(now_ns) and not self._is_new_segment:
            self.suppressed += 1
            return False
        self._last, self._is_new_segment = now_ns, False
        return True

    def _is_double(self, now_ns: int) -> bool:
        """Whether the latest row has the same timestamp and is less than half a period away."""
        if self._last is None or now_ns // self._period != self._last // self._period:
            return False
        return abs(now_ns - self._last) < self._period / 2
