"""Lock-step with nodes in other processes, through services that every ROS 2 node has.

A node answers a parameter request from the same executor that runs its callbacks, after the messages
that arrived before it. All publishers exist before the parameter client, and discovery announces them
in that order: a node that answers has therefore matched every topic, best-effort ones included.

`lock_step` says when they are asked.
"""

import re
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from rcl_interfaces.srv import GetParameters
from rclpy.client import Client
from rclpy.executors import Executor
from rclpy.task import Future
from std_srvs.srv import SetBool, Trigger

from harness.base.documents import parse_json
from harness.base.errors import RunFailed, UsageError
from harness.episode.result import TopicCount
from harness.ros.bridge import Bridge
from harness.ros.context import not_found, spin_until
from rover_metrics.metrics_node import HOLDS, KEEPS_ORDER, LISTENS_ANEW

DISCOVERY_PATIENCE = 15.0  # [s] for a node to be found, or for DDS to match topics
ANSWER_PATIENCE = 30.0  # [s] for one answer; a debugger or a loaded machine may be slow
FIRST_ANSWER_PATIENCE = 3.0  # [s] until the first question is put again
FIRST_QUESTIONS = round(ANSWER_PATIENCE / FIRST_ANSWER_PATIENCE)
BARRIER = GetParameters.Request(names=["use_sim_time"])  # not changed by being sent


class RemoteNode:
    """One node of `--wait-for`.

    Args:
        name: Absolute, or below the bridge's namespace.
        bridge: Publishes to it.
        time_jumps: Whether the run will set its clock back.
        others: The bridges of other rovers in the same world, which publish to it too.

    Attributes:
        name: The full name.
        keeps_order: Whether it has promised to handle everything in the order of its arrival.
        holds: How many messages of a topic may wait for it, as far as it says.
        holds_clocks: How many of /clock.
        waited_s: Wall time for which the run has stood still for its answers [s].
        is_gone: Whether it has stopped answering: then nobody asks it any more.

    Raises:
        UsageError: There is no such node, or it runs on wall time.
    """

    def __init__(
        self, name: str, bridge: Bridge, *, time_jumps: bool = False, others: Sequence[Bridge] = ()
    ) -> None:
        self.name = name if name.startswith("/") else f"{bridge.get_namespace().rstrip('/')}/{name}"
        self._bridge, self._executor, self._others = bridge, bridge.executor, others
        self._parameters = bridge.create_client(GetParameters, f"{self.name}/get_parameters")
        self._counts = bridge.create_client(Trigger, f"{self.name}/received")
        self._lock_step = bridge.create_client(SetBool, f"{self.name}/lock_step")
        if not spin_until(self._executor, self._parameters.service_is_ready, DISCOVERY_PATIENCE):
            raise not_found(bridge, self.name)
        if not self._runs_on_sim_time():
            raise UsageError(f"{self.name} runs on wall time; start it with -p use_sim_time:=true")
        spin_until(self._executor, self._topics_match, DISCOVERY_PATIENCE)
        self.keeps_order, self.holds, self.holds_clocks = False, 1, 1
        self._received_before = self._ask_received()
        if not time_jumps:
            self._begin_lock_step()
        self.waited_s, self.is_gone = 0.0, False

    def ask(self) -> Future:
        """Returns a future that is done when the node has handled all that arrived before."""
        return self._parameters.call_async(BARRIER)

    def release(self, patience: float = ANSWER_PATIENCE) -> dict[str, int]:
        """Tells the node that nobody waits for it any more; waits so long [s] for each of its answers.

        Returns:
            Messages that a MetricsNode has received since the start, by topic; else empty.
        """
        now = {} if self.is_gone else self._ask_received(patience)
        if now:
            self._call(self._lock_step, SetBool.Request(data=False), patience)
        return {topic: count - self._received_before.get(topic, 0) for topic, count in now.items()}

    def has_left(self) -> bool:
        """Returns whether the graph does not show it any more: it ended, or was killed a while ago."""
        return not self._parameters.service_is_ready()

    def _runs_on_sim_time(self) -> bool:
        # A service is seen before it has matched this client: what it answers until then is lost.
        asked: list[Future] = []
        for _ in range(FIRST_QUESTIONS):
            asked.append(self.ask())
            if spin_until(self._executor, lambda: any(f.done() for f in asked), FIRST_ANSWER_PATIENCE):
                values = next(f for f in asked if f.done()).result().values
                return bool(values and values[0].bool_value)
        raise RunFailed(f"{self.name} stopped answering")

    def _begin_lock_step(self) -> None:
        """Notes what a MetricsNode promises, and waits until it can hear with longer queues."""
        before = self._readers()
        promise = self._call(self._lock_step, SetBool.Request(data=True), ANSWER_PATIENCE)
        pattern = KEEPS_ORDER + HOLDS.format(*2 * ["([1-9][0-9]?)"]) + f"({LISTENS_ANEW})?"
        said = re.fullmatch(pattern, "" if promise is None else promise.message)
        if said is None:
            return
        self.keeps_order, self.holds, self.holds_clocks = True, int(said[1]), int(said[2])

        def is_heard() -> bool:
            now = self._readers()
            are_new = all(now[topic] - before[topic] and before[topic] - now[topic] for topic in before)
            return are_new and self._topics_match()

        if said[3]:
            spin_until(self._executor, is_heard, DISCOVERY_PATIENCE)

    def _readers(self) -> dict[str, set[bytes]]:
        """All readers of the topics that a MetricsNode listens to; the graph may not know whose yet."""
        look = self._bridge.get_subscriptions_info_by_topic
        topics = self._received_before
        return {topic: {bytes(reader.endpoint_gid) for reader in look(topic)} for topic in topics}

    def _topics_match(self) -> bool:
        """Whether each publisher knows the readers that the graph shows for its topic."""
        return all(
            c.publisher.get_subscription_count() >= self._bridge.count_subscribers(c.topic)
            for bridge in (self._bridge, *self._others)
            for c in bridge.channels
        )

    def _ask_received(self, patience: float = ANSWER_PATIENCE) -> dict[str, int]:
        answer = self._call(self._counts, Trigger.Request(), patience)
        if answer is None:
            return {}
        published = {topic for b in (self._bridge, *self._others) for topic in b.published()}
        try:
            counts = parse_json(answer.message, self.name)
            return {topic: int(count) for topic, count in counts.items() if topic in published}
        except (UsageError, ValueError, TypeError, AttributeError):  # another node of that name
            return {}

    def _call(
        self, client: Client, request: SetBool.Request | Trigger.Request, patience: float
    ) -> SetBool.Response | Trigger.Response | None:
        """What a service that only a MetricsNode has answers; None without it or without an answer."""
        if not client.service_is_ready():
            return None
        future = client.call_async(request)
        return future.result() if spin_until(self._executor, future.done, patience) else None


def wait_for_answers(
    awaited: Mapping[RemoteNode, Future], executor: Executor, check: Callable[[], None] = lambda: None
) -> None:
    """Returns when all nodes have answered, and counts for how long each was waited for.

    Args:
        awaited: The answer of each node.
        executor: Of the node that asked.
        check: Called while answers are missing; raises if they will not come.

    Raises:
        RunFailed: One of them does not.
    """
    began = time.monotonic()
    silent = dict(awaited)

    def all_have_answered() -> bool:
        for node in [node for node, answer in silent.items() if answer.done()]:
            del silent[node]
            node.waited_s += time.monotonic() - began
        if silent:
            check()
        return not silent or any(node.has_left() for node in silent)

    spin_until(executor, all_have_answered, ANSWER_PATIENCE)
    left = [node for node in silent if node.has_left()]
    for node in left or silent:
        node.is_gone = True
    for node in left or silent:
        raise RunFailed(f"{node.name} {'has ended' if left else 'stopped answering'}")


def counted_by(
    nodes: Iterable[RemoteNode], published: dict[str, TopicCount], patience: float = ANSWER_PATIENCE
) -> dict[str, TopicCount]:
    """Lets nodes go; returns what was published with what the MetricsNodes among them received.

    Args:
        nodes: Are waited for no more.
        published: By topic.
        patience: How long [s] to wait for each answer.
    """
    topics = dict(published)
    for node in nodes:
        for topic, received in node.release(patience).items():
            lost = max(topics[topic].lost, topics[topic].published - received)
            topics[topic] = replace(topics[topic], received=received, lost=lost)
    return topics
