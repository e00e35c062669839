"""A node that looks at the topics around it, and the table of what it has seen."""

import re
import time
from collections import deque
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rich.table import Table

from harness.base.message_types import GRID_MAP
from harness.messages.transforms import TF_MESSAGE
from harness.ros.foreign_type import forget_missing_definition, message_type
from rover_metrics.ros.parameters import BEST_EFFORT, RELIABLE
from rover_metrics.ros.subscriptions import keep_last

WINDOW = 5.0  # [s] of the past that a rate is taken over
SHORTEST = 3.0  # [s] that make a rate right to 2 %: messages are handled up to 30 ms late at either end
LEAST = 0.5  # [s] below which a rate would be wrong by more than a tenth and is not shown
QUEUE = 100  # messages of a topic that may wait for this process
HEARD = 1000  # messages of another node's output that may wait; in lock-step nothing is lost
CLOCK = "/clock"
PLUMBING = ("/rosout", "/parameter_events")  # every node has them
COLUMNS = ("topic", "type", "Hz", "sim Hz", "age [s]", "QoS", "publishers", "subscribers")
TYPE = re.compile(r"([a-z][a-z0-9_]*)/msg/([A-Z][A-Za-z0-9]*)")


class Pace:
    """How fast something grows, and when it last did: messages of a topic, or a simulation's time."""

    def __init__(self) -> None:
        self.points: deque[tuple[float, float]] = deque()  # the last WINDOW, and always the last one

    def note(self, now: float, value: float) -> None:
        """Takes down a value [any unit] at a time [s]; a value that falls starts anew."""
        if self.points and value < self.points[-1][1]:
            self.points.clear()
        self.points.append((now, value))
        self._forget(now)

    def rate(self, now: float) -> float | None:
        """Returns the growth per second over the last WINDOW; None of values less than LEAST apart."""
        if self.span(now) < LEAST:
            return None
        (begin, first), (end, last) = self.points[0], self.points[-1]
        return (last - first) / (end - begin)

    def span(self, now: float) -> float:
        """Returns the seconds that the rate is taken over; 0 without one."""
        self._forget(now)
        return self.points[-1][0] - self.points[0][0] if self.points else 0.0

    def age(self, now: float) -> float | None:
        """Returns the seconds since the last value; None before the first."""
        return now - self.points[-1][0] if self.points else None

    def _forget(self, now: float) -> None:
        while len(self.points) > 1 and self.points[0][0] < now - WINDOW:
            self.points.popleft()


class TopicMonitor:
    """Listens to every topic below a namespace, in best effort so that it holds up nobody.

    Args:
        node: Its subscriptions are made on.
        namespace: Topics outside it are left out, but for /clock.
        now: Wall time [s].

    Attributes:
        types: Of each topic; `counts` are its messages so far, `paces` their rates.
        clock: How fast /clock runs.
    """

    def __init__(self, node: Node, namespace: str, now: Callable[[], float] = time.monotonic) -> None:
        self._node, self._now, self._below = node, now, f"/{namespace}/".replace("//", "/")
        self._qos = QoSProfile(depth=QUEUE, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.types: dict[str, str] = {}
        self.counts: dict[str, int] = {}
        self.paces: dict[str, Pace] = {}
        self.clock = Pace()
        self._is_settling = False

    def look_around(self) -> None:
        """Listens to topics that have turned up; rates begin at the next look.

        What comes while topics are subscribed to is handled in a heap afterwards.
        """
        if self._is_settling:
            for pace in (*self.paces.values(), self.clock):
                pace.points.clear()
        known = len(self.types)
        for topic, types in self._node.get_topic_names_and_types():
            shown = topic.startswith(self._below) or topic == CLOCK
            if topic not in self.types and shown and topic not in PLUMBING:
                self.types[topic] = ", ".join(types)
                self.counts[topic], self.paces[topic] = 0, Pace()
                self._listen(topic, message_class(types[0]))
        self._is_settling = len(self.types) > known

    def table(self) -> Table:
        """Returns what is known now, one row per topic."""
        now, speed = self._now(), self.clock.rate(self._now())
        table = Table(*COLUMNS, title=f"{len(self.types)} topics", title_justify="left")
        for topic in sorted(self.types):
            pace = self.paces[topic]
            rate = pace.rate(now)
            simulated = rate / speed if rate is not None and speed else None
            publishers = self._node.get_publishers_info_by_topic(topic)
            subscribers = self._node.get_subscriptions_info_by_topic(topic)
            others = [s for s in subscribers if s.node_name != self._node.get_name()]
            cells = (_number(rate, 1), _number(simulated, 1), _number(pace.age(now), 2))
            qos = ", ".join(sorted({quality(p.qos_profile) for p in publishers})) or "-"
            table.add_row(topic, self.types[topic], *cells, qos, str(len(publishers)), str(len(others)))
        if speed is not None:
            table.caption = f"{CLOCK} runs at {speed:.1f}x real time"
        return table

    def too_short(self) -> list[str]:
        """Returns the topics that are published and not heard for long enough to tell their rate.

        Latched ones have none: they are sent once.
        """
        now = self._now()
        brief = [topic for topic, pace in sorted(self.paces.items()) if pace.span(now) < SHORTEST]
        return [topic for topic in brief if self._has_rate(topic)]

    def _has_rate(self, topic: str) -> bool:
        publishers = self._node.get_publishers_info_by_topic(topic)
        return any(p.qos_profile.durability != DurabilityPolicy.TRANSIENT_LOCAL for p in publishers)

    def _listen(self, topic: str, kind: type | None) -> None:
        if kind is None:
            return  # a type that is not installed here: shown, not counted

        def received(message: Any) -> None:  # noqa: ANN401 - bytes, or a Clock
            self.counts[topic] += 1
            self.paces[topic].note(self._now(), self.counts[topic])
            if topic == CLOCK:
                self.clock.note(self._now(), message.clock.sec + message.clock.nanosec * 1e-9)

        self._node.create_subscription(kind, topic, received, self._qos, raw=topic != CLOCK)
        forget_missing_definition()


def message_class(type_name: str) -> type | None:
    """Returns the class of a type such as sensor_msgs/msg/Imu; None if it is not installed here.

    The name comes from the network: nothing is imported unless it is a package of ROS messages. Those of
    /tf and of grid maps serve raw subscriptions only where they are not installed.
    """
    if type_name in (TF_MESSAGE, GRID_MAP):
        return message_type(type_name)  # one that is made where it is not installed
    match = TYPE.fullmatch(type_name)
    spec = find_spec(match[1]) if match else None
    folders = spec.submodule_search_locations if spec else None
    if not match or not folders or not any(Path(f, "msg", "__init__.py").is_file() for f in folders):
        return None
    return getattr(import_module(f"{match[1]}.msg"), match[2], None)


def quality(profile: Any) -> str:  # noqa: ANN401 - rclpy has no types
    """Returns reliability, durability unless volatile, and the depth where the middleware tells it."""
    words = [profile.reliability.name.lower().replace("_", " ")]
    if profile.durability.name not in ("VOLATILE", "SYSTEM_DEFAULT", "UNKNOWN"):
        words.append(profile.durability.name.lower().replace("_", " "))
    if profile.history.name == "KEEP_ALL":
        words.append("all")
    elif profile.depth > 0:  # Fast DDS gives 0
        words.append(str(profile.depth))
    return " ".join(words)


def _number(value: float | None, decimals: int) -> str:
    return "-" if value is None else f"{value:.{decimals}f}"


def offered_quality(publishers: Sequence[Any]) -> QoSProfile:
    """Returns what all publishers of a topic offer, with a queue that loses nothing in lock-step."""
    offered = [publisher.qos_profile for publisher in publishers]
    reliable = all(each.reliability == ReliabilityPolicy.RELIABLE for each in offered)
    latched = all(each.durability == DurabilityPolicy.TRANSIENT_LOCAL for each in offered)
    return keep_last(HEARD, RELIABLE if reliable else BEST_EFFORT, latched=latched)
