"""/cmd_vel as Twist or TwistStamped, whichever is sent.

A topic has one type in Fast DDS: a node that hears Twist cannot hear TwistStamped too. So `auto` begins
with the distribution's type, hears the other one as well where the middleware lets it, and else changes
over when only the other one is sent. Nav2 and the base controllers send TwistStamped from Kilted on.
A node in this process cannot even send what is not heard: for those `late` waits for what they send.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib.util import find_spec
from typing import Any

from geometry_msgs.msg import Twist, TwistStamped
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from harness import samples
from harness.episode.result import CommandCount
from rover_metrics.errors import shown
from rover_metrics.ros.subscriptions import keep_last
from rover_metrics.topics import stamp_ns

RCLError = rclpy_implementation.RCLError
STAMPED_BY_DEFAULT = find_spec("rclpy.experimental") is not None  # Kilted brought both
KINDS = {"twist": Twist, "stamped": TwistStamped}
TYPES = {"twist": "geometry_msgs/msg/Twist", "stamped": "geometry_msgs/msg/TwistStamped"}


# Given the topic and its subscription, returns what records a message of it.
Recording = Callable[[str, Any], Callable[[Any], object]]


class Commands:
    """Hears commands and hands on those that the rover can follow.

    Args:
        node: Subscribes.
        kind: "twist", "stamped" or "auto"; "late" is "auto" that hears nothing until something is sent,
            or `begin`, from which on it is Twist in every distribution.
        frames: In which a TwistStamped may be, without a namespace; in none it is in the rover's own.
        take: Is given each command.

    Attributes:
        is_late: Whether it waits for what is sent first.
        count: What has come so far.
        refusal: The first command that was refused, and why; "" if none was.
        clock_ns: What /clock showed last: a stamp before it is older than the present [ns].
        watch: Is given each message once it is taken or refused.
    """

    def __init__(
        self,
        node: Node,
        kind: str,
        frames: tuple[str, ...],
        take: Callable[[samples.Twist], None] | None = None,
    ) -> None:
        self._node, self._frames, self._take = node, frames, take
        self.topic: str = node.resolve_topic_name("cmd_vel")
        self.count, self.refusal, self.clock_ns = CommandCount(), "", 0
        self.watch: Callable[[Any], object] | None = None
        self.is_late = kind == "late"
        self._is_auto, self._has_complained = self.is_late or kind == "auto", False
        self._heard: dict[str, Any] = {}
        self._recording: Recording | None = None
        self._recorders: dict[str, Callable[[Any], object]] = {}
        stamped_first = STAMPED_BY_DEFAULT and kind == "auto"
        self._wanted = ("stamped" if stamped_first else "twist") if self._is_auto else kind
        if not self.is_late:
            self._hear(self._wanted)  # raises for a name that is none
            for other in KINDS.keys() - {self._wanted} if self._is_auto else ():
                with suppress(RCLError):  # Fast DDS hears one type
                    self._hear(other)

    @property
    def heard(self) -> tuple[str, ...]:
        """Returns which kinds are heard; none while it changes over."""
        return tuple(self._heard)

    def begin(self) -> bool:
        """Hears what is wanted; returns whether it does, for the former type may be in use a little."""
        self.is_late = False
        with suppress(RCLError):
            self._hear(self._wanted)
        return bool(self._heard)

    def look_around(self) -> bool:
        """Looks which types are sent and changes over if need be.

        Returns:
            Whether any is heard, or none is sent yet that it waits for. The former subscription may be
            in use until the executor has spun.
        """
        if self.is_late:
            sent = self._sent()
            if not sent:
                return True
            self._wanted = next((kind for kind in TYPES if TYPES[kind] in sent), self._wanted)
        if not self._heard:
            return self.begin()
        matched = sum(subscription.get_publisher_count() for subscription in self._heard.values())
        if matched < self._node.count_publishers(self.topic):
            self._look_at_strangers(alone=not matched)
        return bool(self._heard)

    def record(self, recording: Recording | None) -> None:
        """Has every message recorded from now on, also those that are refused; none with None."""
        self._recording, self._recorders = recording, {}
        for kind in self._heard:
            self._tap(kind)

    def _look_at_strangers(self, *, alone: bool) -> None:
        sent = self._sent()
        missed = [kind for kind, name in TYPES.items() if name in sent and kind not in self._heard]
        if not missed:
            return
        if alone and self._is_auto:
            self._wanted = missed[0]
            for subscription in self._heard.values():
                self._node.destroy_subscription(subscription)
            self._heard.clear()
            said = f"{self.topic} is sent as {TYPES[self._wanted]}, which is heard from now on"
            self._node.get_logger().info(said)
        elif not self._has_complained:
            self._has_complained = True
            heard = " and ".join(TYPES[kind] for kind in self._heard)
            self._node.get_logger().warning(
                f"{self.topic} is also sent as {TYPES[missed[0]]}, which is not heard beside {heard}: "
                f"send one type, or choose with --cmd-vel {missed[0]}"
            )

    def _sent(self) -> set[str]:
        """The types in which somebody sends."""
        return {each.topic_type for each in self._node.get_publishers_info_by_topic(self.topic)}

    def _hear(self, kind: str) -> None:
        receive = partial(self.receive, kind)
        subscription = self._node.create_subscription(KINDS[kind], "cmd_vel", receive, keep_last(10))
        self._heard[kind] = subscription
        self._tap(kind)

    def _tap(self, kind: str) -> None:
        if self._recording is not None and kind not in self._recorders:
            self._recorders[kind] = self._recording(self.topic, self._heard[kind])

    def receive(self, kind: str, message: Any) -> None:  # noqa: ANN401 - rclpy's classes have no types
        """Takes a message of that kind, as it arrives."""
        if kind in self._recorders:
            self._recorders[kind](message)
        {"twist": self._receive, "stamped": self._receive_stamped}[kind](message)
        if self.watch is not None:
            self.watch(message)

    def _receive(self, twist: Twist) -> bool:
        linear, angular = twist.linear.x, twist.angular.z
        if not (math.isfinite(linear) and math.isfinite(angular)):
            self._refuse("a non-finite command", f"linear.x = {linear}, angular.z = {angular}")
            return False
        self.count.taken += 1
        if self._take is not None:
            self._take(samples.Twist(linear, angular))
        return True

    def _receive_stamped(self, message: TwistStamped) -> None:
        frame = message.header.frame_id
        if frame and frame.rpartition("/")[2] not in self._frames:
            ignored = f"a command in the frame '{shown(frame)}'"
            self._refuse(ignored, f"give one of {', '.join(self._frames)}, or none")
        elif self._receive(message.twist) and stamp_ns(message) < self.clock_ns:
            self.count.older += 1

    def _refuse(self, ignored: str, why: str) -> None:
        self.count.refused += 1
        refusal = f"{ignored} on {self.topic}: {why}"
        self.refusal = self.refusal or refusal
        self._node.get_logger().warning(f"ignored {refusal}", throttle_duration_sec=1.0)
