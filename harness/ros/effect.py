"""Lock-step by what a node does: time stands until an output of it has come for each input.

A node that answers a parameter request (`remote`) has emptied the queue of one callback group. One that
computes in a thread of its own, or in two groups, may answer while it still works; its output tells.
Outputs are counted, not matched by their stamps: a node may stamp them with the input's time or its own.
"""

import time
from collections.abc import Sequence

from harness.base.errors import SOURCE_IT, RunFailed, UsageError, unknown
from harness.base.sim_time import NANOSECONDS
from harness.ros.bridge import Bridge
from harness.ros.channel import Channel
from harness.ros.context import QUIET, owner_of, spin_until, spin_until_quiet
from harness.ros.foreign_type import forget_missing_definition
from harness.ros.remote import DISCOVERY_PATIENCE
from harness.ros.topic_monitor import message_class, offered_quality
from harness.spec.ros import Effect

START = "start the node that hears the input and publishes the output, in this ROS_DOMAIN_ID"


class AwaitedEffect:
    """One output that time waits for; a Listener.

    Args:
        effect: The output, and the input that it answers.
        bridges: Of the rovers of the run; names without a namespace are the first one's.

    Attributes:
        name: The output's full name.
        waited_s: Wall time for which the run has stood still for it [s].

    Raises:
        UsageError: The run does not publish the input, nobody hears it, nobody publishes the output, or
            the type of that is not installed.
    """

    def __init__(self, effect: Effect, bridges: Sequence[Bridge]) -> None:
        self._bridge, self._effect = bridges[0], effect
        topics = {c.topic: c for bridge in bridges for c in bridge.channels}
        source = self._resolved(effect.newer_than)
        if source not in topics:
            raise UsageError(f"--wait-for-topic: {unknown('topic of this run', source, topics)}")
        self._input, self._output = topics[source], self._resolved(effect.topic)
        self._count = 0  # of the outputs that have come
        self._due = 0  # the count at which every input is answered
        self.name, self.waited_s = self._output, 0.0
        if not spin_until(self._bridge.executor, lambda: bool(self._publishers()), DISCOVERY_PATIENCE):
            raise UsageError(f"--wait-for-topic {self._output}: nobody publishes it; {START}")
        commands = next((b.commands for b in bridges if b.commands.topic == self._output), None)
        if commands is not None:
            commands.watch = self._take  # what the rover has not heard has had no effect
        else:
            self._subscribe()
        if not spin_until(self._bridge.executor, self._input_is_heard, DISCOVERY_PATIENCE):
            raise UsageError(f"--wait-for-topic {self._output}: nobody hears {source}; {START}")
        # A node that hears an input before it has discovered who waits for the answer answers nobody.
        spin_until_quiet(self._bridge.executor, self._publishers, QUIET, DISCOVERY_PATIENCE)

    def make_room(self, channels: Sequence[Channel]) -> None:
        """Notes that an input goes out; an answer may come before all others have handled it."""
        if self._input in channels:
            self._due = max(self._due, self._count) + 1

    def wait_for_samples(self, channels: Sequence[Channel]) -> None:
        """Does nothing: a node may need the time as well, before it answers."""

    def wait_for_clock(self, stamp_ns: int) -> None:
        """Returns when the last input has been answered.

        Args:
            stamp_ns: The time that was published.

        Raises:
            RunFailed: No answer came within the time-out.
        """
        began = time.monotonic()
        executor, limit = self._bridge.executor, self._effect.timeout
        has_come = spin_until(executor, lambda: self._count >= self._due, limit)
        self.waited_s += time.monotonic() - began
        if not has_come:
            names = ", ".join(self._publishers()) or "nobody any more"
            raise RunFailed(
                f"no {self._output} came within {self._effect.timeout:g} s of wall time for the "
                f"{self._input.topic} of {stamp_ns / NANOSECONDS:.2f} s; it is published by {names}"
            )

    def _take(self, _: object) -> None:
        self._count += 1

    def _resolved(self, name: str) -> str:
        return name if name.startswith("/") else self._bridge.resolve_topic_name(name)

    def _publishers(self) -> list[str]:
        return sorted(map(owner_of, self._bridge.get_publishers_info_by_topic(self._output)))

    def _input_is_heard(self) -> bool:
        """Whether a node of others has matched the input: it may be seen after its output is."""
        readers = self._bridge.get_subscriptions_info_by_topic(self._input.topic)
        own = {node.get_name() for node in self._bridge.executor.get_nodes()}
        matched: int = self._input.publisher.get_subscription_count()
        return matched >= len(readers) and any(reader.node_name not in own for reader in readers)

    def _subscribe(self) -> None:
        publishers = self._bridge.get_publishers_info_by_topic(self._output)
        kind = message_class(name := publishers[0].topic_type)
        if kind is None:
            raise UsageError(f"--wait-for-topic {self._output}: {name} is not installed; {SOURCE_IT}")
        quality = offered_quality(publishers)
        self._bridge.create_subscription(kind, self._output, self._take, quality, raw=True)
        forget_missing_definition()
