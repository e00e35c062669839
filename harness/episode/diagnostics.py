"""/rover/metrics of a run without ROS: what metrics_node would publish with each row."""

from collections.abc import Sequence

from harness.base.message_types import made
from harness.messages.blank import blank, cdr
from harness.messages.refilled import set_stamp
from harness.sensors.table import Topic
from rover_metrics.core.columns import Row
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.health.live_view import LiveView, Status
from rover_metrics.health.reception import Reception
from rover_metrics.session import MetricsSession, Remark
from rover_metrics.topics import SENSORS, sources_of

METRICS = Topic("rover/metrics", "diagnostic_msgs/msg/DiagnosticArray")
STATUS, PAIR = "diagnostic_msgs/msg/DiagnosticStatus", "diagnostic_msgs/msg/KeyValue"


class Diagnostics:
    """Keeps the account of what the metrics were given, and tells it with each row.

    Args:
        session: Whose topics they are.
        space: The rover's namespace, with a slash in front; "" without one.
        stale_after_ns: From which silence on a topic is missed [ns].
    """

    def __init__(self, session: MetricsSession, space: str, stale_after_ns: int) -> None:
        self._space, self._stale_after_ns = space, stale_after_ns
        self._view, self._reception = LiveView(), Reception(lambda _: None)
        self._sources = {source.name: source for source in sources_of(session)}
        for name, source in self._sources.items():
            self._reception.listen(space + name, may_be_missing=source not in SENSORS)

    def arrived(self, name: str, stamp_ns: int, remark: Remark | None) -> None:
        """Counts a message.

        Args:
            name: Of its topic, without the rover's namespace.
            stamp_ns: Of its header [ns].
            remark: What was odd about it; None if nothing was.
        """
        topic = self._space + name
        self._reception.arrived(topic, stamp_ns if self._sources[name].has_stamp else None)
        if remark is not None and remark.left_out:
            self._reception.reject(topic, remark.finding)
        elif remark is not None:
            self._reception.remark(topic, remark.finding)

    def message(self, now_ns: int, row: Row, thresholds: Thresholds) -> bytes:
        """Returns the message that is published with a row.

        Args:
            now_ns: Time on the ROS clock [ns].
            row: The latest.
            thresholds: What is too much in a row.
        """
        for topic in self._reception.received:
            self._reception.publishers(topic, 1)
        self._reception.look(now_ns, self._stale_after_ns)
        statuses = self._view.statuses(row, self._reception.states(), thresholds, now_ns)
        return self._made(now_ns, statuses)

    def _made(self, now_ns: int, statuses: Sequence[Status]) -> bytes:
        message, hardware = blank(METRICS.message_type), self._space.strip("/") or "rover"
        set_stamp(message.header.stamp, now_ns)
        message.status = [
            made(
                STATUS,
                int(status.level),
                f"metrics_node: {status.name}",
                status.message,
                hardware,
                [made(PAIR, *pair) for pair in status.values],
            )
            for status in statuses
        ]
        return cdr(message)
