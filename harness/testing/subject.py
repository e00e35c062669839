"""The node under test, hosted in this process or started as one of its own, and what is heard of it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from rclpy.node import Node

from harness.base.errors import RunFailed
from harness.ros.bridge import Bridge
from harness.ros.channel import Channel
from harness.ros.context import SPIN_TIMEOUT, spin_until
from harness.ros.remote import RemoteNode, wait_for_answers
from harness.testing.process import EXIT_PATIENCE, Programs

Message = TypeVar("Message")


class Subject(RemoteNode):
    """A node that must have handled everything before time goes on; a Listener.

    It knows every subscription that was made here before: DDS announces a participant's endpoints in
    order, and a node that answers a new client has heard of what is older than that client.

    Args:
        name: Its fully qualified name.
        bridge: What publishes to it.
        programs: One of which it may be of: then it can answer no more when that has ended.
        node: The rclpy node if it is hosted; the bridge's executor spins it too.
        time_jumps: Whether faults will set the clock back.

    Raises:
        UsageError: There is no such node, or it runs on wall time.
    """

    def __init__(
        self,
        name: str,
        bridge: Bridge,
        programs: Programs,
        node: Any = None,  # noqa: ANN401 - rclpy has no types
        *,
        time_jumps: bool = False,
    ) -> None:
        self.node, self._programs, self._owes = node, programs, False
        super().__init__(name, bridge, time_jumps=time_jumps)

    def make_room(self, channels: Sequence[Channel]) -> None:  # noqa: ARG002 - all is waited for at once
        """Returns when it has handled what it was not waited for yet."""
        if self._owes:
            self._wait()

    def wait_for_samples(self, channels: Sequence[Channel]) -> None:  # noqa: ARG002
        """Returns when it has handled its queue, whatever it listens to: other nodes may feed it too.

        One that keeps order is sure to do so before the /clock that follows.
        """
        if self.keeps_order:
            self._owes = True
        else:
            self._wait()

    def wait_for_clock(self, stamp_ns: int) -> None:  # noqa: ARG002 - the barrier knows no times
        """Returns when it has handled its queue and its timers have run."""
        self._wait()
        if self.keeps_order:
            return
        while self.node is not None and _timer_is_due(self.node):
            self._executor.spin_once(timeout_sec=SPIN_TIMEOUT)
        self._wait()

    def _wait(self) -> None:
        try:
            wait_for_answers({self: self.ask()}, self._executor, self._programs.check)
        except RunFailed as error:
            self._programs.check()  # which says more
            if self.has_left():  # a program leaves the graph a moment before its exit code is known
                spin_until(self._executor, self._still_runs, EXIT_PATIENCE)
            raise RunFailed(self._programs.told(str(error))) from error
        self._owes = False

    def _still_runs(self) -> bool:
        """False; RunFailed, which says how it ended, if it can answer no more."""
        self._programs.check()
        return False


@dataclass(eq=False)
class Heard(Generic[Message]):
    """The messages of one topic, in the order in which they arrived; its length counts them all.

    Attributes:
        topic: Its resolved name.
        messages: The latest of them, at most `most`; `times` are the simulated seconds of their arrival.
        count: How many have arrived.
    """

    topic: str
    most: int
    messages: list[Message] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    count: int = 0

    def __len__(self) -> int:
        return self.count

    def take(self, message: Message, time: float) -> None:
        """Keeps a message that arrived at a simulated second, and forgets the oldest above `most`."""
        self.count += 1
        self.messages.append(message)
        self.times.append(time)
        if len(self.messages) > self.most:
            del self.messages[0], self.times[0]

    @property
    def latest(self) -> Message:
        """The last message; AssertionError if nothing has been heard."""
        if not self.messages:
            raise AssertionError(f"nothing has been heard on {self.topic}")
        return self.messages[-1]


def _timer_is_due(node: Node) -> bool:
    """Whether a timer on a node's own clock is to be called."""
    clock = node.get_clock()
    return any(timer.clock is clock and timer.is_ready() for timer in node.timers)
