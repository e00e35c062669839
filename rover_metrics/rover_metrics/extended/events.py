"""Events out of samples: what touches for a second at 20 Hz is one touch, not twenty."""

CONTACT_GAP_NS = 500_000_000  # contacts closer together are one event, as in the simulator's truth


class EventCounter:
    """Counts the beginnings of events; a new one needs a pause before it.

    Args:
        gap_ns: How long nothing may have been active before a new event [ns].

    Attributes:
        count: Events so far.
    """

    def __init__(self, gap_ns: int) -> None:
        self.count = 0
        self._gap_ns = gap_ns
        self._last_ns: int | None = None

    def active(self, time_ns: int) -> None:
        """Take note of a sample within an event."""
        last, self._last_ns = self._last_ns, time_ns
        if last is None or abs(time_ns - last) >= self._gap_ns:  # a clock set back parts events too
            self.count += 1
