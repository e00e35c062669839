"""How fast something grows: messages of a topic, or a simulation's time."""

from collections import deque

WINDOW = 5.0  # [s] of the past that a rate is taken over


class Pace:
    """How fast something grows, and when it last did: messages of a topic, or a simulation's time."""

    def __init__(self) -> None:
        self._points: deque[tuple[float, float]] = deque()
        self._last: float | None = None

    def note(self, now: float, value: float) -> None:
        """Takes down a value [any unit] at a time [s]; a value that falls starts anew."""
        if self._points and value < self._points[-1][1]:
            self._points.clear()
        self._points.append((now, value))
        self._last = now
        self._forget(now)

    def rate(self, now: float) -> float | None:
        """Growth per second over the last WINDOW; None if fewer than two values fell into it."""
        self._forget(now)
        if len(self._points) < 2 or self._points[0][0] == self._points[-1][0]:
            return None
        (begin, first), (end, last) = self._points[0], self._points[-1]
        return (last - first) / (end - begin)

    def age(self, now: float) -> float | None:
        """Seconds since the last value; None before the first."""
        return None if self._last is None else now - self._last

    def _forget(self, now: float) -> None:
        while self._points and self._points[0][0] < now - WINDOW:
            self._points.popleft()
