"""Publishes what the node computes, for Foxglove, PlotJuggler and rqt; the log does not depend on it."""

from collections.abc import Callable, Iterable

from rclpy.node import Node
from rclpy.time import Time

from rover_metrics.errors import is_worth_a_line
from rover_metrics.health.live_view import Status
from rover_metrics.ros.subscriptions import keep_last

try:
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
except ImportError:  # the log is written without it
    DiagnosticArray = None

TOPIC = "rover/metrics"


class MetricsPublisher:
    """Publishes statuses as diagnostic_msgs/DiagnosticArray while it is `enabled` and somebody listens.

    Statuses are named as diagnostic_updater names them, "node: what", and the hardware is the rover:
    the node's namespace, or "rover". A function `record` takes each message, also those for nobody.

    Args:
        node: Publishes.
        tell: Takes lines for the user.
        enabled: At first; may be changed.
    """

    def __init__(self, node: Node, tell: Callable[[str], None], *, enabled: bool) -> None:
        self.enabled = enabled
        self._tell, self._failures = tell, 0
        self._name = node.get_name()
        self._hardware = node.get_namespace().strip("/") or "rover"
        self.publisher = None
        self.record: Callable[[DiagnosticArray], object] | None = None
        if DiagnosticArray is not None:
            self.publisher = node.create_publisher(DiagnosticArray, TOPIC, keep_last(10))
        elif enabled:
            tell(f"{TOPIC} is not published: diagnostic_msgs is not installed; the log is written")

    @property
    def listeners(self) -> int:
        """How many subscriptions there are."""
        return 0 if self.publisher is None else int(self.publisher.get_subscription_count())

    def publish(self, now_ns: int, statuses: Callable[[], Iterable[Status]]) -> None:
        """Publishes statuses, computed only if somebody listens; a failure is reported, no more."""
        publisher, record = self.publisher, self.record
        if not self.enabled or publisher is None:
            return
        try:
            if self.listeners or record is not None:
                message = self._message(now_ns, statuses())
                publisher.publish(message)
                if record is not None:
                    record(message)
        except Exception as error:  # noqa: BLE001 - whatever it is, the next row must be written
            self._failures += 1
            if is_worth_a_line(self._failures - 1, self._failures):
                reason = " ".join(f"{type(error).__name__}: {error}".split())
                self._tell(f"cannot publish {TOPIC}: {reason} ({self._failures} so far); rows go on")

    def _message(self, now_ns: int, statuses: Iterable[Status]) -> "DiagnosticArray":
        message = DiagnosticArray()
        message.header.stamp = Time(nanoseconds=now_ns).to_msg()
        message.status = [
            DiagnosticStatus(
                level=bytes([status.level]),
                name=f"{self._name}: {status.name}",
                message=status.message,
                hardware_id=self._hardware,
                values=[KeyValue(key=key, value=value) for key, value in status.values],
            )
            for status in statuses
        ]
        return message
