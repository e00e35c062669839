"""When a MetricsNode writes its rows as /clock comes in, worked out without ROS.

Two rules meet: that of rcl's timers, modelled here, and the node's own (rover_metrics.timing.row_times).
Runs without ROS and replays follow them; tests/e2e holds them to the real node, through every fault of
the clock.
"""

from rover_metrics.timing.row_times import RowTimes


class RosTimer:
    """A timer on ROS time that was made when the time was `start_ns`; 0 is before the first /clock.

    After a jump ahead the missed calls are skipped; after a jump to before the last call the next one
    comes a period later (rcl_timer_call and _rcl_timer_time_jump of rcl/timer.c).
    """

    def __init__(self, period_ns: int, start_ns: int = 0) -> None:
        self._period_ns = period_ns
        self._next_ns = (start_ns // period_ns + 1) * period_ns
        self._last_ns = start_ns

    def fires_at(self, now_ns: int) -> bool:
        """Takes the next time of /clock; whether the timer is called then."""
        if now_ns < self._last_ns:
            self._last_ns, self._next_ns = now_ns, now_ns + self._period_ns
        if now_ns < self._next_ns:
            return False
        missed = (now_ns - self._next_ns) // self._period_ns
        self._last_ns = now_ns
        self._next_ns += (missed + 1) * self._period_ns
        return True


class RowSchedule:
    """The timer and the node's guard over it; ask with every time that /clock tells."""

    def __init__(self, period_ns: int, start_ns: int = 0) -> None:
        self._timer, self._times = RosTimer(period_ns, start_ns), RowTimes(period_ns)
        self._jump_ns = period_ns // 2  # as the node's callback for jumps has it
        self._now_ns = start_ns

    def is_due(self, now_ns: int) -> bool:
        """Whether a row is written at that time."""
        ahead_ns = now_ns - self._now_ns
        self._now_ns = now_ns
        if ahead_ns >= self._jump_ns:
            self._times.leapt_ahead()
        elif ahead_ns <= -self._jump_ns:
            self._times.went_back()
        return self._timer.fires_at(now_ns) and self._times.is_due(now_ns)
