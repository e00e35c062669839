"""When rows are due as the time of a recording goes on."""

from enum import Enum

from rover_metrics.timing.row_schedule import RowSchedule

NANOSECONDS = 1_000_000_000
LONGEST_GAP = 60  # seconds without a message in which rows go on, as those of a live node would


class TimeSource(Enum):
    """Which time the rows follow."""

    AUTO = "auto"  # SIM where the recording has /clock, else RECORDED
    SIM = "sim"  # /clock
    RECORDED = "recorded"  # when each message was recorded
    HEADER = "header"  # the header stamps of the sensors' messages


class FullSeconds:
    """Tells which rows are due as recorded or header time goes on: one for each second that is full.

    Attributes:
        jumps: Where time went back, or ahead by more than LONGEST_GAP; a line each.
    """

    def __init__(self) -> None:
        self.jumps: list[str] = []
        self._latest_ns: int | None = None
        self._second = 0

    def due(self, time_ns: int) -> range:
        """Take the time of the next message; gives the seconds that are full before it.

        A time that is up to a second older than the latest is late, not a jump: it moves nothing.
        """
        second, previous, latest = (time_ns - 1) // NANOSECONDS, self._second, self._latest_ns
        if latest is None or time_ns < latest - NANOSECONDS:
            second = previous = time_ns // NANOSECONDS
        elif time_ns < latest:
            return range(0)
        elif second - previous > LONGEST_GAP:
            previous = second - 1
        if latest is not None and previous != self._second:
            self.jumps.append(_jump(latest, time_ns))
        # Not back where a second message of the moment at which a recording begins is not beyond it yet.
        self._latest_ns, self._second = time_ns, max(previous, second)
        return range(previous + 1, second + 1)

    def rest(self) -> range:
        """The second that ends with the recording, if one does."""
        if self._latest_ns is None:
            return range(0)
        return range(self._second + 1, self._latest_ns // NANOSECONDS + 1)


class ClockSeconds:
    """Tells which rows are due as /clock goes on: those of a live node that heard it from the start on.

    Nothing is due before the first full second, nor does anything fire at the end.

    Attributes:
        jumps: Where time went back, or ahead by more than a second; a line each.
    """

    def __init__(self) -> None:
        self.jumps: list[str] = []
        self._latest_ns: int | None = None
        self._schedule = RowSchedule(NANOSECONDS)

    def due(self, time_ns: int) -> range:
        """Take the next time of /clock; gives the second whose row is due, if one is."""
        latest, self._latest_ns = self._latest_ns, time_ns
        if latest is None:
            self._schedule = RowSchedule(NANOSECONDS, time_ns)
        elif abs(time_ns - latest) > NANOSECONDS:
            self.jumps.append(_jump(latest, time_ns))
        second = time_ns // NANOSECONDS
        return range(second, second + self._schedule.is_due(time_ns))

    def rest(self) -> range:
        """Nothing: a timer does not fire at the end."""
        return range(0)


def _jump(before_ns: int, after_ns: int) -> str:
    return f"time jumps from {before_ns / NANOSECONDS:.2f} s to {after_ns / NANOSECONDS:.2f} s"
