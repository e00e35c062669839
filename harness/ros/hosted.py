"""The MetricsNode in this process: its callbacks are counted against what was published."""

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace

from rclpy.parameter import Parameter

from harness.base.errors import RunFailed, UsageError
from harness.base.sim_time import NANOSECONDS
from harness.episode.result import TopicCount
from harness.ros.bridge import SECOND_PUBLISHER, Bridge
from harness.ros.channel import Channel
from harness.ros.context import spin_until
from harness.ros.remote import DISCOVERY_PATIENCE
from rover_metrics.core.columns import Row
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.metrics_node import MetricsNode

PATIENCE = 10.0  # [s] of wall time without any progress before messages are given up


class HostedMetrics:
    """A MetricsNode that must have handled everything before time goes on; a Listener.

    Args:
        bridge: Publishes to it.
        node: The node; the bridge's executor is to spin it, too, from now on.

    Attributes:
        topics: Those that the node listens to and the bridge publishes; /clock is not among them.
        lost: Messages given up, by topic: not handled although nothing else happened for PATIENCE.
    """

    def __init__(self, bridge: Bridge, node: MetricsNode) -> None:
        self._bridge, self._executor, self.node = bridge, bridge.executor, node
        self._looked_ns = 0  # when it was last seen whether others have sent messages, too
        self._channels = [channel for channel in bridge.channels if channel.topic in node.received]
        self._clock_channel, self._clocks_before = bridge.clock_channel, node.clocks
        self._take = node.host(channel.topic for channel in (*self._channels, self._clock_channel))
        self.topics = tuple(channel.topic for channel in self._channels)
        self.lost = dict.fromkeys((*self.topics, self._clock_channel.topic), 0)

    def await_match(self) -> None:
        """Waits until each of its topics, and /clock, has its listener.

        Raises:
            UsageError: DDS does not connect them.
        """

        def alone() -> list[str]:
            channels = (*self._channels, self._clock_channel)
            return [c.topic for c in channels if not c.publisher.get_subscription_count()]

        if not spin_until(self._executor, lambda: not alone(), DISCOVERY_PATIENCE):
            raise UsageError(
                f"DDS did not connect {', '.join(alone())} within {DISCOVERY_PATIENCE:.0f} s; "
                "is ROS_AUTOMATIC_DISCOVERY_RANGE=OFF set, or a firewall on the loopback device?"
            )

    @property
    def last_row(self) -> Row | None:
        """The latest row of the node's log; None before the first."""
        return self.node.last_row

    @property
    def thresholds(self) -> Thresholds:
        """What counts as an event."""
        return self.node.settings.thresholds

    def use(self, thresholds: Thresholds) -> None:
        """Sets them as parameters of the node."""
        values = asdict(thresholds).items()
        self.node.set_parameters_atomically([Parameter(name, value=value) for name, value in values])

    def received(self) -> dict[str, int]:
        """Returns the messages handled, by topic."""
        handled = {topic: self.node.received[topic] for topic in self.topics}
        return handled | {self._clock_channel.topic: self.node.clocks - self._clocks_before}

    def make_room(self, channels: Sequence[Channel]) -> None:
        """Returns at once: nothing of it waits between two ticks."""

    def wait_for_samples(self, channels: Sequence[Channel] = ()) -> None:
        """Has the node handle what has gone out until the counts agree; gives up what does not come.

        Args:
            channels: On which something has just gone out: mostly it has arrived with that.

        Raises:
            RunFailed: Messages arrived that this run did not send.
        """
        handled = [self._handles_one(channel) for channel in channels]
        if channels and all(handled):
            return
        deadline, overdue = time.monotonic() + PATIENCE, False
        while missing := self._missing():
            if overdue:
                for topic, count in missing.items():
                    self.lost[topic] += count
                return
            overdue = time.monotonic() > deadline  # who was stopped for long has yet to look what came
            self._executor.spin_once(timeout_sec=0.0)  # with nothing to be served it naps
            for topic in missing:
                self._take[topic](None)

    def _handles_one(self, channel: Channel) -> bool:
        """Has the node handle one message of a topic that it listens to; whether that was the last."""
        topic = channel.topic
        if (take := self._take.get(topic)) is None:
            return True
        take(1)
        is_clock = channel is self._clock_channel
        handled = self.node.clocks - self._clocks_before if is_clock else self.node.received[topic]
        return bool(handled + self.lost[topic] == channel.published)

    def wait_for_clock(self, stamp_ns: int) -> None:  # noqa: ARG002 - it may stand still
        """Has the node take the time, at which it serves its timer; as for samples."""
        if self._bridge.time_ns >= self._looked_ns + NANOSECONDS:
            self._looked_ns = self._bridge.time_ns
            self.take_all()
            self.wait_for_samples()
        elif not self._handles_one(self._clock_channel):
            self.wait_for_samples()

    def take_all(self) -> None:
        """Has the node handle all that has come, also what this run has not sent."""
        for take in self._take.values():
            take(None)

    def _missing(self) -> dict[str, int]:
        """How many messages are not handled yet, of each topic that has any."""
        received, lost = self.received(), self.lost
        missing: dict[str, int] = {}
        for channel in (*self._channels, self._clock_channel):
            topic = channel.topic
            count = channel.published - received[topic] - lost[topic]
            if count < 0:
                raise RunFailed(f"{topic} {SECOND_PUBLISHER}")
            if count:
                missing[topic] = count
        return missing


def heard_by(
    hosts: Iterable[HostedMetrics], published: Mapping[str, TopicCount]
) -> dict[str, TopicCount]:
    """Returns what was published and received by topic; of a shared one the most that a node lost."""
    topics = dict(published)
    for host in hosts:
        for topic, received in host.received().items():
            lost = max(topics[topic].lost, host.lost[topic])
            topics[topic] = replace(topics[topic], received=received, lost=lost)
    return topics
