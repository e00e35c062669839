"""In which order messages are played: as they were written, but for those of another program."""

from collections.abc import Callable, Collection, Iterator
from heapq import merge

from rover_metrics.bag.mcap_stream import Message
from rover_metrics.timing import NANOSECONDS

MOST_SET_BACK = 10  # times, by less than a second, that a recorder's clock may be
# What was recorded, some topics with their bytes; what could not be read goes into the list.
Read = Callable[[Collection[str], list[str]], Iterator[Message]]


def in_time(read: Read, wanted: Collection[str], problems: list[str]) -> Iterator[Message]:
    """Returns what was recorded as it was written; by its times if that was in another order.

    Args:
        read: Reads it.
        wanted: Topics, of which the first comes first where times are equal; where messages were
            written in another order the others are left out.
        problems: Takes what could not be read, a line each.
    """
    is_shuffled, is_by_topic = _order(read)
    if is_shuffled:
        places = {topic: place for place, topic in enumerate(wanted)}
        messages = (message for message in read(wanted, problems) if message.topic in wanted)
        return iter(sorted(messages, key=lambda message: (message.time_ns, places[message.topic])))
    if not is_by_topic:
        return read(wanted, problems)

    def of(topic: str, problems: list[str]) -> Iterator[Message]:
        return (message for message in read([topic], problems) if message.topic == topic)

    parts = (of(topic, [] if number else problems) for number, topic in enumerate(wanted))
    return merge(*parts, key=lambda message: message.time_ns)


def _order(read: Read) -> tuple[bool, bool]:
    """Whether messages are shuffled, and whether they were written topic by topic.

    Within a topic time goes back a little, again and again; or it goes back in none, but in all. A
    clock that is set back goes back seldom, or far: what it did is told, not mended.
    """
    latest, newest = dict[str, int](), 0
    steps_back, goes_back, is_set_back = 0, False, False
    for topic, time_ns, _ in read((), []):
        back = latest.get(topic, 0) - time_ns
        is_set_back |= back > 0
        steps_back += 0 < back < NANOSECONDS
        goes_back |= time_ns < newest - NANOSECONDS
        latest[topic], newest = time_ns, max(newest, time_ns)
    return steps_back > MOST_SET_BACK, goes_back and not is_set_back
