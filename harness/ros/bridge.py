"""The ROS node `harness`: publishes samples as RoboTerrain's Gazebo bridge would, in lock-step.

It counts what it publishes per topic and listens to /cmd_vel. Topic names are relative, so remapping
and namespaces work; in the root namespace they are those of the README's table.
"""

from collections.abc import Callable, Iterable, Sequence
from itertools import chain
from typing import Protocol

from rclpy.context import Context

from harness import samples
from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS
from harness.messages.outlets import CLOCK, Outlets, bursts
from harness.messages.outlets import clock as clock_fill
from harness.robots import RoverSpec
from harness.robots.frames.tree import ODOM, Description
from harness.ros.channel import Channel, open_channel
from harness.ros.commands import Commands
from harness.ros.context import serve_waiting
from harness.ros.frames import FrameTopics
from rover_metrics.ros.guarded_node import GuardedNode

# In odom are those of Nav2's pure pursuit controllers, which mean the base: they copy its pose's header.
COMMAND_FRAMES = ("base_link", "base_footprint", ODOM)
SECOND_PUBLISHER = (
    "has a second publisher: what it sends would be logged as this run's; "
    "give each run a ROS_DOMAIN_ID of its own (0 to 101), or names and a clock of its own: "
    "--namespace NAME --ros-args -r /clock:=/NAME/clock"
)


class Listener(Protocol):
    """Somebody who must have handled everything before time goes on."""

    def make_room(self, channels: Sequence["Channel"]) -> None:
        """Returns when a message may go out on each of these channels without pushing out another."""

    def wait_for_samples(self, channels: Sequence["Channel"]) -> None:
        """Returns when what went out on them is handled, or sure to be before all that follows."""

    def wait_for_clock(self, stamp_ns: int) -> None:
        """Returns when it has the time and its timers have run, or will have before all that follows."""


class Bridge(GuardedNode):
    """Publishes ticks.

    Args:
        rover: Whose frames commands may be in.
        outlets: What is published of each sample.
        context: Of rclpy; the default one if None.
        on_command: Takes each command of /cmd_vel.
        cmd_vel: How commands come: "twist", "stamped" or "auto".
        namespace: Of its topics, where there are several rovers.
        clock: /clock, if another bridge tells the time; None if this one does.

    Attributes:
        channels_of: The topics of each sensor's samples, in publishing order.
        time_ns: Simulation time of the tick that goes out now, whatever a fault does to its stamp.
    """

    def __init__(
        self,
        rover: RoverSpec,
        outlets: Outlets,
        *,
        context: Context | None = None,
        on_command: Callable[[samples.Twist], None] | None = None,
        cmd_vel: str = "twist",
        namespace: str = "",
        clock: Channel | None = None,
    ) -> None:
        super().__init__("harness", context=context, namespace=namespace)
        self.time_ns = 0
        self.frames = FrameTopics(self)
        self.channels_of: dict[samples.Source, list[Channel]] = {
            source: [open_channel(self, *outlet) for outlet in some] for source, some in outlets.items()
        }
        self.channels_of[samples.Transforms] = self.frames.moving
        # Reliable serves best-effort listeners (rclpy's own) and reliable ones alike.
        self._tells_time = clock is None
        self.clock_channel = open_channel(self, CLOCK, clock_fill()) if clock is None else clock
        frames = dict.fromkeys((rover.odometry_child_frame, *COMMAND_FRAMES))
        self.commands = Commands(self, cmd_vel, tuple(frames), on_command)

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Returns every topic that it publishes; /clock is the last, if it does that."""
        samples_ = chain.from_iterable(self.channels_of.values())
        clock = (self.clock_channel,) if self._tells_time else ()
        return (*self.frames.fixed, *samples_, *clock)

    def describe(self, description: Description) -> None:
        """Publishes a rover's fixed frames; the transforms of ticks to come are of its moving ones."""
        self.frames.describe(description)

    def advance(self, tick: samples.Tick, sent: samples.Tick, *, listeners: Sequence[Listener]) -> None:
        """Publishes one tick; returns when all listeners have handled it, and all else is served.

        Args:
            tick: Of the episode.
            sent: What faults have left of it.
            listeners: Are waited for.
        """
        self.send(tick, sent, listeners=listeners)
        self.publish_clock(sent, listeners=listeners)
        serve_waiting(self.executor)

    def send(self, tick: samples.Tick, sent: samples.Tick, *, listeners: Sequence[Listener]) -> None:
        """Publishes the samples of one tick; the arguments are those of `advance`."""
        self.time_ns = tick.stamp_ns
        if tick.stamp_ns % NANOSECONDS == 0:
            self.frames.refuse_rivals()
        for burst in bursts(sent.samples):
            outlets = [(sample, self.channels_of[sensor]) for sensor, sample in burst.items()]
            channels = [channel for _, some in outlets for channel in some]
            for listener in listeners:
                listener.make_room(channels)
            for sample, some in outlets:
                for channel in some:
                    channel.publish(sample)
            for listener in listeners:
                listener.wait_for_samples(channels)

    def publish_clock(
        self, sent: samples.Tick, *, listeners: Sequence[Listener], others: Sequence["Bridge"] = ()
    ) -> None:
        """Publishes the time of one tick; returns when all listeners have handled it.

        Args:
            sent: What faults have left of the tick.
            listeners: Are waited for.
            others: The bridges of rovers in the same world, which have sent their samples.
        """
        if sent.tells_time:
            self.clock_channel.publish(sent)
            for bridge in (self, *others):
                bridge.commands.clock_ns = sent.stamp_ns
            for listener in listeners:
                listener.wait_for_clock(sent.stamp_ns)

    def published(self) -> dict[str, int]:
        """Returns the messages published so far, by resolved topic name."""
        return {c.topic: c.published for c in (*self.channels, self.clock_channel)}

    def stop_recording(self) -> None:
        """Lets messages go out as they are, again."""
        self.commands.record(None)
        for channel in self.channels:
            channel.record, channel.is_wanted = None, bool

    def refuse_other_publishers(self, topics: Iterable[str]) -> None:
        """Another harness or simulator would mix into the log; what starts later is caught in lock-step.

        Raises:
            UsageError: One of these topics, or /clock, has a second publisher.
        """
        for topic in (*topics, self.clock_channel.topic):
            if self.count_publishers(topic) > 1:
                raise UsageError(f"{topic} {SECOND_PUBLISHER}")
