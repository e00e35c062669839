"""When the nodes of `--wait-for` are asked, and waited for.

Nodes are asked at the same time, so the slowest of them sets the pace and not their sum. After samples
only those are asked that listen to one of their topics; after /clock all are, since all follow it.

A node that has promised to handle what arrives in its order, timers included, comes to the same however
late it is. It is waited for only where a queue of its might overflow: before a second message of a topic
goes out, for a subscription may hold the newest one alone, or before one more than the node says that
its queues hold, or than a socket may hold of what is on its way. It is asked when two thirds of that are
used. So it works while the simulation goes on, and few questions and answers wake it and the simulator.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from rclpy.task import Future

from harness.base.sim_time import NANOSECONDS
from harness.ros.bridge import Bridge
from harness.ros.channel import Channel
from harness.ros.context import owner_of
from harness.ros.remote import RemoteNode, wait_for_answers

ROOM = 175_000  # [bytes] that may be on their way: a socket of UDP takes 208 KiB on Linux
OVERHEAD = 800  # [bytes] that a message takes there beside its own
UNKNOWN = "_NODE_NAME_UNKNOWN_"  # of a reader whose node the graph does not know (yet)


@dataclass
class Backlog:
    """Messages that a node which keeps order is not known to have handled.

    Attributes:
        node: The node.
        answer: Its answer, awaited or come; None before it was asked.
        asked: How many messages of each topic the answer stands for.
        later: How many have gone out after the question.
        asked_bytes, later_bytes: What those take on their way.
    """

    node: RemoteNode
    answer: Future | None = None
    asked: Counter[str] = field(default_factory=Counter)
    later: Counter[str] = field(default_factory=Counter)
    asked_bytes: int = 0
    later_bytes: int = 0

    def add(self, channel: Channel) -> None:
        """Counts a message that has gone out."""
        self.later[channel.topic] += 1
        self.later_bytes += channel.size + OVERHEAD

    def is_full(self, topics: Sequence[str]) -> bool:
        """Returns whether nothing more may go out on one of these topics, or on any."""
        self._look()
        is_much = any(self.of(topic) >= self.node.holds for topic in topics)
        return is_much or self.asked_bytes + self.later_bytes > ROOM

    def is_due(self, clock: str) -> bool:
        """Returns whether two thirds of what may wait may be used; `clock` is the name of /clock."""
        rooms = {clock: self.node.holds_clocks}
        is_much = any(3 * n >= 2 * rooms.get(topic, self.node.holds) for topic, n in self.later.items())
        return is_much or 3 * self.later_bytes > 2 * ROOM

    def of(self, topic: str) -> int:
        """Returns how many messages of a topic may wait in the node's queue."""
        self._look()
        return self.asked[topic] + self.later[topic]

    def question(self) -> Future:
        """Returns the awaited answer; asks, if there is none."""
        self._look()
        if self.answer is None:
            self.answer, self.asked, self.later = self.node.ask(), self.later, Counter()
            self.asked_bytes, self.later_bytes = self.later_bytes, 0
        return self.answer

    def _look(self) -> None:
        if self.answer is not None and self.answer.done():
            self.answer, self.asked, self.asked_bytes = None, Counter(), 0


class RemoteNodes:
    """The nodes of `--wait-for`; a Listener.

    Args:
        nodes: Must have handled everything before time goes on.
        bridge: Publishes to them.
    """

    def __init__(self, nodes: Iterable[RemoteNode], bridge: Bridge) -> None:
        self._nodes, self._bridge = list(nodes), bridge
        self._backlogs = {node.name: Backlog(node) for node in self._nodes if node.keeps_order}
        self._others = [node for node in self._nodes if not node.keeps_order]
        self._listening: dict[str, tuple[int, list[RemoteNode]]] = {}
        self._looked_ns = 0  # of the simulation, when it was last looked who listens

    def make_room(self, channels: Sequence[Channel]) -> None:
        """Returns when each node that keeps order has room for a message of each of these channels.

        Raises:
            RunFailed: One of them does not answer.
        """
        topics = [channel.topic for channel in channels]
        while full := [b for b in self._backlogs.values() if b.is_full(topics)]:
            answers = {backlog.node: backlog.question() for backlog in full}
            wait_for_answers(answers, self._bridge.executor)

    def wait_for_samples(self, channels: Sequence[Channel]) -> None:
        """Returns when those that listen to these channels have handled their queues, or keep order.

        Args:
            channels: On which samples have just gone out.

        Raises:
            RunFailed: One of them does not answer.
        """
        if self._bridge.time_ns >= self._looked_ns + NANOSECONDS:
            # One may have come when another went: counts do not show it.
            self._looked_ns = self._bridge.time_ns
            self._listening.clear()
        asked: dict[str, RemoteNode] = {}
        for channel in channels:
            for node in self._listeners(channel):
                if node.keeps_order:
                    self._backlogs[node.name].add(channel)
                else:
                    asked[node.name] = node
        wait_for_answers({node: node.ask() for node in asked.values()}, self._bridge.executor)

    def wait_for_clock(self, stamp_ns: int) -> None:  # noqa: ARG002 - it may stand still
        """Returns when all have handled their queues, /clock and timers included, or keep order.

        Raises:
            RunFailed: One of them does not answer.
        """
        awaited = {node: node.ask() for node in self._others}
        clock = self._bridge.clock_channel
        for backlog in self._backlogs.values():
            backlog.add(clock)
            if backlog.of(clock.topic) > backlog.node.holds_clocks:
                awaited[backlog.node] = backlog.question()
            elif backlog.is_due(clock.topic):
                backlog.question()  # answered while the simulation goes on
        wait_for_answers(awaited, self._bridge.executor)

    def _listeners(self, channel: Channel) -> list[RemoteNode]:
        """The nodes that listen to a topic; all while the graph does not say whose each reader is."""
        matched = channel.publisher.get_subscription_count()
        count, nodes = self._listening.get(channel.topic, (-1, []))
        if count == matched:
            return nodes
        readers = self._bridge.get_subscriptions_info_by_topic(channel.topic)
        names = {*map(owner_of, readers)}
        if len(readers) < matched or any(UNKNOWN in name for name in names):
            return self._nodes
        nodes = [node for node in self._nodes if node.name in names]
        self._listening[channel.topic] = matched, nodes
        return nodes
