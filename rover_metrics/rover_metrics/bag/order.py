"""In which order messages are played: as they stand in a file, but for one that was made of tables."""

from collections.abc import Callable, Collection, Iterator
from heapq import merge

from rover_metrics.bag.mcap_stream import Message
from rover_metrics.timing import NANOSECONDS

# A file's messages, those of some topics with their bytes; what could not be read goes into the list.
Read = Callable[[Collection[str], list[str]], Iterator[Message]]


def in_time(read: Read, wanted: Collection[str], problems: list[str]) -> Iterator[Message]:
    """Returns what a file holds as it stands there, or by its times if it was written topic by topic.

    Args:
        read: Reads the file.
        wanted: Topics; of a file by topic the others are left out.
        problems: Takes what could not be read, a line each.
    """
    if not _is_by_topic(read):
        return read(wanted, problems)

    def of(topic: str, problems: list[str]) -> Iterator[Message]:
        return (message for message in read([topic], problems) if message.topic == topic)

    parts = (of(topic, [] if number else problems) for number, topic in enumerate(wanted))
    return merge(*parts, key=lambda message: message.time_ns)


def _is_by_topic(read: Read) -> bool:
    """Whether time goes back in a file, but in none of its topics: no clock was set back then."""
    latest, newest, goes_back = dict[str, int](), 0, False
    for topic, time_ns, _ in read((), []):
        if time_ns < latest.get(topic, 0):
            return False
        goes_back |= time_ns < newest - NANOSECONDS
        latest[topic], newest = time_ns, max(newest, time_ns)
    return goes_back
