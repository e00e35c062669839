"""The unit of time, and from when on two times are those of different clocks."""

NANOSECONDS = 1_000_000_000

# [s] No two ends of one session are a day apart, nor is a clock that was set to another time zone;
# simulated time and the time of day are decades apart.
OTHER_CLOCK = 86_400.0
