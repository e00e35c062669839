"""Where the messages of a run go besides its listeners: into a recording, to Foxglove."""

from collections.abc import Callable
from contextlib import ExitStack
from typing import NamedTuple, Protocol

from harness.base.errors import UsageError
from harness.sensors.table import Topic
from harness.spec.ros import RosOptions

KEEP_LAST, RELIABLE, BEST_EFFORT, VOLATILE, TRANSIENT_LOCAL = 1, 1, 2, 2, 1  # as rmw counts them
INSTALL = "install it with pip install 'rover-harness[foxglove]'"


class Endpoint(NamedTuple):
    """A topic of which a sink gets the messages.

    Attributes:
        topic: Its whole name.
        message_type: As in sensor_msgs/msg/Imu.
        depth: How many messages may wait for a listener.
        history: As rmw counts, as reliability and durability are.
        is_foreign: Whether DDS wrote the bytes, which leaves in their padding whatever was in memory.
        is_late: Whether several nodes publish it in any order, after all else of a tick.
    """

    topic: str
    message_type: str
    depth: int
    history: int = KEEP_LAST
    reliability: int = RELIABLE
    durability: int = VOLATILE
    is_foreign: bool = False
    is_late: bool = False

    @property
    def latched(self) -> bool:
        """Returns whether late subscribers get the last messages too (transient local)."""
        return self.durability == TRANSIENT_LOCAL


def endpoint(topic: Topic, name: str) -> Endpoint:
    """Returns a topic of this run under its whole name."""
    reliability = BEST_EFFORT if topic.best_effort else RELIABLE
    durability = TRANSIENT_LOCAL if topic.latched else VOLATILE
    return Endpoint(name, topic.message_type, topic.depth, KEEP_LAST, reliability, durability)


class Intake(NamedTuple):
    """A sink's end of a topic.

    Attributes:
        take: Takes each message, with its simulation time [ns].
        is_wanted: Returns whether it would go anywhere: messages are made only if somebody gets them.
    """

    take: Callable[[int, bytes], object]
    is_wanted: Callable[[], bool]


class Sink(Protocol):
    """Takes the messages of some topics."""

    def open(self, endpoint: Endpoint) -> Intake:
        """Returns where the messages of a topic go."""
        ...


def sinks_of(options: RosOptions, at_end: ExitStack) -> list[Sink]:
    """Opens the recording and serves Foxglove, if options ask for them, until `at_end` closes them.

    Raises:
        UsageError: One cannot be opened.
    """
    sinks: list[Sink] = []
    if options.record is not None:
        from harness.messages.recorder import Recorder  # noqa: PLC0415 - most runs record nothing

        sinks.append(at_end.enter_context(Recorder(options.record, overwrite=options.overwrite)))
    if options.foxglove is not None:
        try:
            from harness.messages.foxglove import Foxglove  # noqa: PLC0415 - its extra may be missing
        except ModuleNotFoundError as error:
            raise UsageError(f"--foxglove: {error}; {INSTALL}") from error
        sinks.append(at_end.enter_context(Foxglove(options.foxglove)))
    return sinks
