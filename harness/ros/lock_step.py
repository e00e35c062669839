"""When the nodes of `--wait-for` are asked, and waited for.

Nodes are asked at the same time, so the slowest of them sets the pace and not their sum. After samples
only those are asked that listen to one of their topics; after /clock all are, since all follow it.

A node that has promised to handle what arrives in its order, timers included, comes to the same however
late it is. It is waited for only where a queue of its might overflow: before a second message of a topic
goes out, for a subscription may hold the newest one alone, or before one more than the node says that
its queues hold. It is asked when they may be half full. So it works while the simulation goes on, and
few questions and answers wake it and the simulator.
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

UNKNOWN = "_NODE_NAME_UNKNOWN_"  # of a reader whose node the graph does not know (yet)


@dataclass
class Backlog:
    """Messages that a node which keeps order is not known to have handled.

    Attributes:
        node: The node.
        answer: Its answer, awaited or come; None before it was asked.
        asked: How many messages of each topic the answer stands for.
        later: How many have gone out after the question.
    """

    node: RemoteNode
    answer: Future | None = None
    asked: Counter[str] = field(default_factory=Counter)
    later: Counter[str] = field(default_factory=Counter)

    def of(self, topic: str) -> int:
        """Returns how many messages of a topic may wait in the node's queue."""
        self._look()
        return self.asked[topic] + self.later[topic]

    def question(self) -> Future:
        """Returns the awaited answer; asks, if there is none."""
        self._look()
        if self.answer is None:
            self.answer, self.asked, self.later = self.node.ask(), self.later, Counter()
        return self.answer

    def _look(self) -> None:
        if self.answer is not None and self.answer.done():
            self.answer, self.asked = None, Counter()


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

    def make_room(self, channels: Sequence[Channel]) -> None:
        """Returns when no node that keeps order has a message of these channels in its queue.

        Raises:
            RunFailed: One of them does not answer.
        """
        topics = [channel.topic for channel in channels]
        while full := [
            b for b in self._backlogs.values() if any(b.of(t) >= b.node.holds for t in topics)
        ]:
            answers = {backlog.node: backlog.question() for backlog in full}
            wait_for_answers(answers, self._bridge.executor)

    def wait_for_samples(self, channels: Sequence[Channel]) -> None:
        """Returns when those that listen to these channels have handled their queues, or keep order.

        Args:
            channels: On which samples have just gone out.

        Raises:
            RunFailed: One of them does not answer.
        """
        asked: dict[str, RemoteNode] = {}
        for channel in channels:
            for node in self._listeners(channel):
                if node.keeps_order:
                    self._backlogs[node.name].later[channel.topic] += 1
                else:
                    asked[node.name] = node
        wait_for_answers({node: node.ask() for node in asked.values()}, self._bridge.executor)

    def wait_for_clock(self, stamp_ns: int) -> None:
        """Returns when all have handled their queues, /clock and timers included, or keep order.

        Raises:
            RunFailed: One of them does not answer.
        """
        if stamp_ns % NANOSECONDS == 0:  # one may have come when another went: counts do not show it
            self._listening.clear()
        awaited = {node: node.ask() for node in self._others}
        clock = self._bridge.clock_channel.topic
        for backlog in self._backlogs.values():
            backlog.later[clock] += 1
            node, room = backlog.node, {clock: backlog.node.holds_clocks}
            if backlog.of(clock) > node.holds_clocks:
                awaited[node] = backlog.question()
            elif any(2 * n >= room.get(t, node.holds) for t, n in backlog.later.items()):
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
