"""When a row is due: once a period, whatever clock and executor do; and when a new segment begins.

RowTimes is the node's rule. RowSchedule applies it to the times of /clock without ROS, with rcl's timers
modelled: runs without ROS and replays follow it, and tests/e2e holds it to the real node, through every
fault of the clock.
"""


class RowTimes:
    """Guards the rows of one session against timers that fire twice and clocks that are set.

    A segment ends where time goes back: the simulator was restarted or its clock reset. Executors under
    load fire a timer twice in a row, and two clocks that fight make it fire with every message.

    Attributes:
        jump_ns: From which step on the clock has not gone on but was set [ns].
        segments: Segments so far, this one included.
    """

    def __init__(self, period_ns: int) -> None:
        self._period, self.jump_ns, self.segments = period_ns, period_ns // 2, 1
        self._last = -period_ns  # time of the latest row
        self._is_new_segment = False  # and time has passed in it without a leap

    def went_back(self) -> None:
        """Begins a new segment: the clock has been set back."""
        self.segments += 1
        self._is_new_segment = True

    def leapt_ahead(self) -> None:
        """Takes note that the clock has been set ahead: what fires now is no full period."""
        self._is_new_segment = False

    def is_due(self, now_ns: int) -> bool:
        """Returns whether a timer that fires now is to write a row; if so, counts on that it does.

        It is not if the latest row has the same timestamp and is less than half a period away.
        """
        same = now_ns // self._period == self._last // self._period
        if same and abs(now_ns - self._last) < self._period / 2 and not self._is_new_segment:
            return False
        self._last, self._is_new_segment = now_ns, False
        return True


class RowSchedule:
    """The node's timer on ROS time and its guard over it; ask with every time that /clock tells.

    After a jump ahead the missed calls of the timer are skipped; after a jump to before the last call
    the next one comes a period later (rcl_timer_call and _rcl_timer_time_jump of rcl/timer.c). It was
    made when the time was `start_ns`; 0 is before the first /clock.

    Attributes:
        now_ns: The latest time of /clock [ns].
    """

    def __init__(self, period_ns: int, start_ns: int = 0) -> None:
        self.now_ns = self._called_ns = start_ns
        self._period_ns, self._times = period_ns, RowTimes(period_ns)
        self._next_ns = (start_ns // period_ns + 1) * period_ns

    def is_due(self, now_ns: int) -> bool:
        """Returns whether a row is written at that time."""
        ahead_ns, self.now_ns = now_ns - self.now_ns, now_ns
        if ahead_ns >= self._times.jump_ns:
            self._times.leapt_ahead()
        elif ahead_ns <= -self._times.jump_ns:
            self._times.went_back()
        return self._fires() and self._times.is_due(now_ns)

    def _fires(self) -> bool:
        if self.now_ns < self._called_ns:
            self._called_ns, self._next_ns = self.now_ns, self.now_ns + self._period_ns
        if self.now_ns < self._next_ns:
            return False
        self._called_ns = self.now_ns
        self._next_ns += ((self.now_ns - self._next_ns) // self._period_ns + 1) * self._period_ns
        return True
