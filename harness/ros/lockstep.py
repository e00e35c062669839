"""Lock-step: simulation time does not advance past a message that a listener has not handled.

For each tick the samples go out and are handled, then /clock goes out and is handled with the timers
that it triggers. A listener is either a MetricsNode hosted here, whose callbacks are counted, or a
node in another process, which answers a parameter request only when its queue is empty.
"""

import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import Protocol

from rclpy.executors import Executor

from harness.errors import RunFailed
from harness.ros.bridge import Bridge
from harness.ros.executor import SPIN_TIMEOUT
from harness.samples import Sample, Tick
from rover_metrics.metrics_node import MetricsNode

SECOND_PUBLISHER = (
    "has a second publisher: what it sends would be logged as this run's; "
    "give each run a ROS_DOMAIN_ID of its own (0 to 101), or names and a clock of its own: "
    "--namespace NAME --ros-args -r /clock:=/NAME/clock"
)
PATIENCE = 10.0  # [s] of wall time without any progress before messages are given up


class Listener(Protocol):
    """Somebody who must have handled everything before time goes on."""

    def wait_for_samples(self) -> None:
        """Returns when every published sample has been handled."""
        ...

    def wait_for_clock(self, stamp_ns: int) -> None:
        """Returns when the time has been taken over and its timers have run."""
        ...


class LockStep:
    """Publishes ticks and waits for the listeners."""

    def __init__(self, bridge: Bridge, executor: Executor, listeners: tuple[Listener, ...]) -> None:
        self._bridge, self._executor, self._listeners = bridge, executor, listeners

    def advance(self, tick: Tick) -> None:
        """Publishes one tick; returns when all listeners have handled it."""
        for burst in _bursts(tick):
            self._bridge.publish_samples(burst)
            for listener in self._listeners:
                listener.wait_for_samples()
        if tick.tells_time:
            self._bridge.publish_clock(tick)
            for listener in self._listeners:
                listener.wait_for_clock(tick.stamp_ns)
        if not self._listeners:
            self._executor.spin_once(timeout_sec=0.0)  # /cmd_vel and parameter services


def _bursts(tick: Tick) -> Iterator[Tick]:
    """Parts with at most one sample of a kind: a listener's queue may hold only the latest message."""
    bursts: list[list[Sample]] = []
    sent: Counter[type[Sample]] = Counter()
    for sample in tick.samples:
        if sent[type(sample)] == len(bursts):
            bursts.append([])
        bursts[sent[type(sample)]].append(sample)
        sent[type(sample)] += 1
    for burst in bursts:
        yield replace(tick, samples=tuple(burst))


class HostedMetrics:
    """A MetricsNode in this process; its callbacks are counted against what was published.

    Attributes:
        lost: Messages given up, by topic: not handled although nothing else happened for PATIENCE.
    """

    def __init__(self, bridge: Bridge, executor: Executor, node: MetricsNode) -> None:
        self._executor, self._node = executor, node
        self._clock = node.get_clock()
        self._channels = [channel for channel in bridge.channels if channel.topic in node.received]
        self._clock_topic = bridge.clock_channel.topic
        self._possible_ns = {self._clock.now().nanoseconds}  # what its clock may show
        self.clock_received = 0
        self.lost = {channel.topic: 0 for channel in self._channels} | {self._clock_topic: 0}

    @property
    def topics(self) -> tuple[str, ...]:
        """Topics that the node listens to and the bridge publishes."""
        return tuple(channel.topic for channel in self._channels)

    def received(self) -> dict[str, int]:
        """Messages handled, by topic."""
        handled = {topic: self._node.received[topic] for topic in self.topics}
        return handled | {self._clock_topic: self.clock_received}

    def wait_for_samples(self) -> None:
        """Spins until the counts agree; gives up what does not come.

        Raises:
            RunFailed: Messages arrived that this run did not send.
        """
        deadline = time.monotonic() + PATIENCE
        while self._outstanding():
            if time.monotonic() > deadline:
                self._give_up()
                return
            self._executor.spin_once(timeout_sec=SPIN_TIMEOUT)

    def wait_for_clock(self, stamp_ns: int) -> None:
        """Spins until the node's clock shows the time and no timer of the node is due.

        Raises:
            RunFailed: Somebody else sets the clock too.
        """
        self._possible_ns.add(stamp_ns)
        deadline = time.monotonic() + PATIENCE
        while (now_ns := self._clock.now().nanoseconds) != stamp_ns or self._timer_is_due():
            if now_ns not in self._possible_ns:
                raise RunFailed(f"{self._clock_topic} {SECOND_PUBLISHER}")
            if time.monotonic() > deadline:
                self.lost[self._clock_topic] += 1
                return
            self._executor.spin_once(timeout_sec=SPIN_TIMEOUT)
        self._possible_ns = {stamp_ns}
        self.clock_received += 1
        self._outstanding()  # a stranger's message stood for one of ours until all had arrived

    def _timer_is_due(self) -> bool:
        return any(timer.clock is self._clock and timer.is_ready() for timer in self._node.timers)

    def _outstanding(self) -> bool:
        received, lost = self._node.received, self.lost
        outstanding = False
        for channel in self._channels:
            topic = channel.topic
            missing = channel.published - received[topic] - lost[topic]
            if missing < 0:
                raise RunFailed(f"{topic} {SECOND_PUBLISHER}")
            outstanding |= missing > 0
        return outstanding

    def _give_up(self) -> None:
        for channel in self._channels:
            topic = channel.topic
            self.lost[topic] = channel.published - self._node.received[topic]
