"""Lock-step with a node in another process, through services that every ROS 2 node has.

A node answers a parameter request from the same executor that runs its callbacks, after the messages
that arrived before it. All publishers exist before the parameter client, and discovery announces them
in that order: a node that answers has therefore matched every topic, best-effort ones included.
"""

import json

from rclpy.parameter_client import AsyncParameterClient
from std_srvs.srv import Trigger

from harness.errors import RunFailed, UsageError
from harness.ros.bridge import Bridge
from harness.ros.context import spin_until

DISCOVERY_PATIENCE = 15.0  # [s] for a node to be found, or for DDS to match topics
ANSWER_PATIENCE = 30.0  # [s] for one answer; a debugger or a loaded machine may be slow


class RemoteNode:
    """One node of `--wait-for`; a Listener.

    Raises:
        UsageError: There is no such node, or it runs on wall time.
    """

    def __init__(self, name: str, bridge: Bridge) -> None:
        self.name = name if name.startswith("/") else f"{bridge.get_namespace().rstrip('/')}/{name}"
        self._bridge, self._executor = bridge, bridge.executor
        self._parameters = AsyncParameterClient(bridge, self.name)
        self._counts = bridge.create_client(Trigger, f"{self.name}/received")
        if not spin_until(self._executor, self._parameters.services_are_ready, DISCOVERY_PATIENCE):
            raise UsageError(self._not_found())
        if not self._ask_sim_time():
            raise UsageError(f"{self.name} runs on wall time; start it with -p use_sim_time:=true")
        spin_until(self._executor, self._topics_match, DISCOVERY_PATIENCE)
        self._received_before = self._ask_received()

    def wait_for_samples(self) -> None:
        """Returns when the node has handled its queue.

        Raises:
            RunFailed: It does not answer.
        """
        self._ask_sim_time()

    def wait_for_clock(self, stamp_ns: int) -> None:  # noqa: ARG002 - the barrier knows no times
        """Returns when the node has handled its queue, /clock and timers included."""
        self._ask_sim_time()

    def received(self, patience: float = ANSWER_PATIENCE) -> dict[str, int]:
        """Returns messages that a MetricsNode has received since the start, by topic; else empty.

        Args:
            patience: How long [s] to wait for its answer.
        """
        now = self._ask_received(patience)
        return {topic: count - self._received_before.get(topic, 0) for topic, count in now.items()}

    def _ask_sim_time(self) -> bool:
        """Whether the node runs on simulation time; it answers from its own executor."""
        future = self._parameters.get_parameters(["use_sim_time"])
        if not spin_until(self._executor, future.done, ANSWER_PATIENCE):
            raise RunFailed(f"{self.name} stopped answering")
        values = future.result().values
        return bool(values and values[0].bool_value)

    def _topics_match(self) -> bool:
        """Whether each publisher knows the readers that the graph shows for its topic."""
        return all(
            c.publisher.get_subscription_count() >= self._bridge.count_subscribers(c.topic)
            for c in self._bridge.channels
        )

    def _ask_received(self, patience: float = ANSWER_PATIENCE) -> dict[str, int]:
        if not self._counts.service_is_ready():
            return {}
        future = self._counts.call_async(Trigger.Request())
        if not spin_until(self._executor, future.done, patience):
            return {}
        published = self._bridge.published()
        try:
            told = json.loads(future.result().message)
            return {topic: int(count) for topic, count in told.items() if topic in published}
        except (ValueError, TypeError, AttributeError):  # a service of that name, no MetricsNode's
            return {}

    def _not_found(self) -> str:
        others = sorted(
            f"{namespace.rstrip('/')}/{name}"
            for name, namespace in self._bridge.get_node_names_and_namespaces()
            if name != self._bridge.get_name()
        )
        running = ", ".join(others) or "none (same ROS_DOMAIN_ID and discovery range?)"
        return f"node {self.name} was not found; running: {running}"
