"""What the readers of recordings have in common: a message, and what can go wrong."""

from typing import NamedTuple

from rover_metrics.errors import RoverMetricsError


class BagError(RoverMetricsError):
    """A path that is no rosbag2 recording, or one of which nothing can be read."""


class Message(NamedTuple):
    """One recorded message.

    Attributes:
        topic: Its topic.
        time_ns: When it was recorded, on the recorder's clock [ns].
        data: Its CDR bytes; empty where they were not asked for.
    """

    topic: str
    time_ns: int
    data: bytes


class UnreadableError(Exception):
    """A file of which nothing can be read."""
