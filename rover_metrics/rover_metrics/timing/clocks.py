"""The unit of time, what passes between two times, and when they are those of different clocks."""

NANOSECONDS = 1_000_000_000

EVENT_GAP_NS = NANOSECONDS // 2  # contacts closer together than this are one event, in truth and metrics

# [s] No two ends of one session are a day apart, nor is a clock that was set to another time zone;
# simulated time and the time of day are decades apart.
OTHER_CLOCK = 86_400.0


def age(now_ns: int, stamp_ns: int) -> float | None:
    """Returns how old a stamp is [s]; None if it was never set, or by another clock."""
    seconds = (now_ns - stamp_ns) / NANOSECONDS
    return seconds if stamp_ns and abs(seconds) <= OTHER_CLOCK else None


def rate(count: int, since_ns: int | None, now_ns: int) -> float | None:
    """Returns how often something came [Hz]; None if no time has passed, or from when is not known.

    Args:
        count: How many times it came.
        since_ns: Start of the interval [ns].
        now_ns: Its end [ns].
    """
    if since_ns is None or now_ns <= since_ns:
        return None
    return count / ((now_ns - since_ns) / NANOSECONDS)
