"""When a row is due: once a period, whatever clock and executor do; and the arithmetic of clocks.

RowTimes is the node's rule. RowSchedule applies it to the times of /clock without ROS, with rcl's timers
modelled: runs without ROS and replays follow it, and tests/e2e holds it to the real node, through every
fault of the clock. ClockRows and FullSeconds are for recordings: by /clock, or by the full seconds.
"""

from enum import Enum

NANOSECONDS = 1_000_000_000

EVENT_GAP_NS = NANOSECONDS // 2  # contacts closer together than this are one event, in truth and metrics

# [s] No two ends of one session are a day apart, nor is a clock that was set to another time zone;
# simulated time and the time of day are decades apart.
OTHER_CLOCK = 86_400.0

LONGEST_GAP = 60  # seconds without a message in which rows go on, as those of a live node would


def age(now_ns: int, stamp_ns: int) -> float | None:
    """Returns how old a stamp is [s]; None if it was never set, or by another clock."""
    seconds = (now_ns - stamp_ns) / NANOSECONDS
    return seconds if stamp_ns and abs(seconds) <= OTHER_CLOCK else None


def rate(count: int, since_ns: int | None, now_ns: int) -> float | None:
    """Returns how often something came [Hz]; None if no time has passed or the begin is not known.

    Args:
        count: How many came between the two times.
        since_ns: The begin [ns]; None if it is not known.
        now_ns: The end [ns].
    """
    if since_ns is None or now_ns <= since_ns:
        return None
    return count / ((now_ns - since_ns) / NANOSECONDS)


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


class TimeSource(Enum):
    """Which time the rows follow."""

    AUTO = "auto"  # SIM where the recording has /clock, else RECORDED
    SIM = "sim"  # /clock
    RECORDED = "recorded"  # when each message was recorded
    HEADER = "header"  # the header stamps of the sensors' messages


class ClockRows:
    """The rows of a live node that heard /clock from the start on.

    Nothing is due before the first full second, nor does a timer fire at the end. A line of `jumps` says
    where time went back, or ahead by more than a second.
    """

    def __init__(self) -> None:
        self.jumps: list[str] = []
        self._schedule: RowSchedule | None = None

    def due(self, time_ns: int) -> list[int]:
        """Takes the next time of /clock; returns it if a row is due then [ns]."""
        if self._schedule is None:
            self._schedule = RowSchedule(NANOSECONDS, time_ns)
        elif abs(time_ns - self._schedule.now_ns) > NANOSECONDS:
            self.jumps.append(_jump(self._schedule.now_ns, time_ns))
        return [time_ns] if self._schedule.is_due(time_ns) else []

    def rest(self) -> list[int]:
        """Returns no times: a period that did not end has no row."""
        return []


class FullSeconds:
    """A row for each second that is full as recorded or header time goes on.

    A line of `jumps` says where time went back, or ahead by more than LONGEST_GAP.
    """

    def __init__(self) -> None:
        self.jumps: list[str] = []
        self._latest_ns: int | None = None
        self._second = 0

    def due(self, time_ns: int) -> list[int]:
        """Takes the time of the next message; returns the rows that are due before it [ns].

        A time that is up to a second older than the latest is late, not a jump: it moves nothing.
        """
        second, previous, latest = (time_ns - 1) // NANOSECONDS, self._second, self._latest_ns
        if latest is None or time_ns < latest - NANOSECONDS:
            second = previous = time_ns // NANOSECONDS
        elif time_ns < latest:
            return []
        elif second - previous > LONGEST_GAP:
            previous = second - 1
        if latest is not None and previous != self._second:
            self.jumps.append(_jump(latest, time_ns))
        # Not back where a second message of the moment at which a recording begins is not beyond it yet.
        self._latest_ns, self._second = time_ns, max(previous, second)
        return _seconds(previous, second)

    def rest(self) -> list[int]:
        """Returns the row of the second that ends with the recording, if one does [ns]."""
        if self._latest_ns is None:
            return []
        return _seconds(self._second, self._latest_ns // NANOSECONDS)


def _seconds(after: int, last: int) -> list[int]:
    return [second * NANOSECONDS for second in range(after + 1, last + 1)]


def _jump(before_ns: int, after_ns: int) -> str:
    return f"time jumps from {before_ns / NANOSECONDS:.2f} s to {after_ns / NANOSECONDS:.2f} s"
