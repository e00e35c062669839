"""When rows are due as the time of a recording goes on: by /clock, or by the full seconds."""

from enum import Enum

from rover_metrics.timing.clocks import NANOSECONDS
from rover_metrics.timing.row_times import RowSchedule

LONGEST_GAP = 60  # seconds without a message in which rows go on, as those of a live node would


class TimeSource(Enum):
    """Which time the rows follow."""

    AUTO = "auto"  # SIM where the recording has /clock, else RECORDED
    SIM = "sim"  # /clock
    RECORDED = "recorded"  # when each message was recorded
    HEADER = "header"  # the header stamps of the sensors' messages


class ClockRows:
    """The rows of a live node that heard /clock from the start on.

    Nothing is due before the first full second, nor does a timer fire at the end.

    Attributes:
        jumps: Where time went back, or ahead by more than a second; a line each.
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

    Attributes:
        jumps: Where time went back, or ahead by more than LONGEST_GAP; a line each.
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
