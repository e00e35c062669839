"""MetricsNode: subscriptions, parameters, a timer. Hands messages to TraversalMetrics, no more."""

import json
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from rover_metrics.errors import ParameterError, missing_ros, printable

try:
    from rcl_interfaces.msg import SetParametersResult
    from rclpy.context import Context
    from rclpy.parameter import Parameter
    from rclpy.subscription import Subscription
    from std_srvs.srv import SetBool, Trigger

    from rover_metrics.ros.guarded_node import CLOCKS, GuardedNode
    from rover_metrics.ros.metrics_publisher import MetricsPublisher
    from rover_metrics.ros.parameters import declare_settings, require_same_columns, wrong_name_or_type
    from rover_metrics.ros.program import HAS_EVENTS_EXECUTOR, run_node
    from rover_metrics.ros.row_timer import RowTimer
    from rover_metrics.ros.subscriptions import Listening, taker
except ImportError as error:
    raise missing_ros(error, is_program=__name__ == "__main__") from None

from rover_metrics.extended.settings import Settings, check_name
from rover_metrics.extended.traffic_columns import POSE, SCAN
from rover_metrics.health.live_view import LiveView, Status
from rover_metrics.health.reception import LOST
from rover_metrics.health.rejections import NO_POSE
from rover_metrics.log.buffered_log import BufferedLog
from rover_metrics.log.session_record import SessionRecord
from rover_metrics.session import MetricsSession
from rover_metrics.timing import NANOSECONDS
from rover_metrics.topics import Message, Source, sources_of, stamp_ns

if TYPE_CHECKING:
    from rover_metrics.core.columns import Row

KEEPS_ORDER = "handles everything, its rows included, in the order of its arrival"
HOLDS = "; {} messages of each topic and {} of /clock may wait"
LISTENS_ANEW = ", for it listens anew"
AHEAD = 100  # messages of a topic that may wait while a simulator runs ahead
SPARE = 2  # places of a queue that it does not speak of


class MetricsNode(GuardedNode):
    """Logs the traversal metrics of a rover once per second of ROS time.

    Args:
        settings: The defaults of the node's parameters; a launch, a parameter file or `--ros-args`
            wins over them.
        context: The rclpy context; the default one if None.
        parameter_overrides: Parameter values as a launch would give them.
        now: Wall clock for the name of the log.
        namespace: As for a Node.

    Attributes:
        session: Takes the samples and makes the rows; `metrics` are its twelve columns.
        log: The CSV log of this session, and `record` the JSON beside it.
        reception: What arrived on each topic, what was odd about it and what is missing.
        topics: The resolved name of each topic that is listened to.
        last_row: The latest row, written or not; None before the first.
        in_lock_step: Whether a simulator waits until this node has handled what it sent.
        is_hosted: Whether it is part of a simulator's process, which waits for it too.
    """

    _taken: tuple[Subscription, ...] = ()  # whose messages no executor serves
    _is_whole = False  # else a signal came while it was made

    def __init__(
        self,
        settings: Settings | None = None,
        *,
        context: Context | None = None,
        parameter_overrides: list[Parameter] | None = None,
        now: Callable[[], datetime] = datetime.now,
        namespace: str | None = None,
    ) -> None:
        options = {"context": context, "parameter_overrides": parameter_overrides}
        super().__init__("metrics_node", namespace=namespace, **options)
        try:
            for name in self._parameter_overrides:  # rclpy ignores one that nobody declares
                check_name(name, may_be_others=True)
            self.settings = declare_settings(self, settings or Settings())
            extended = self.settings.extended if self.settings.extended_columns else None
            self.session = MetricsSession(self.settings.thresholds, extended)
            self.metrics = self.session.metrics
            self.setup_subscribers()
            self.log = BufferedLog(
                Path(self.settings.log_dir).expanduser(),
                now(),
                self._tell,
                fsync=self.settings.fsync,
                columns=self.session.columns,
            )
        except Exception:  # what rclpy refuses, too
            super().destroy_node()
            raise
        self.last_row: Row | None = None
        self.in_lock_step = self.is_hosted = False
        self.record = SessionRecord(self.get_fully_qualified_name(), now, self._tell)
        self.record.begin(self.log.path)
        self._view = LiveView()
        self.publisher = MetricsPublisher(self, self._tell, enabled=self.settings.publish_metrics)
        self.timer = RowTimer(self, self._each_second, self._tell, self.settings.stale_after)
        self.add_on_set_parameters_callback(self._use_parameters)
        self.create_service(Trigger, "~/received", self._report_received)
        self.create_service(SetBool, "~/lock_step", self._set_lock_step)
        self._is_whole = True
        self.get_logger().info(printable(f"logging to: {self.log.path.parent}/"))

    @property
    def received(self) -> dict[str, int]:
        """Messages received, by resolved topic name."""
        return self.reception.received

    @property
    def rows(self) -> int:
        """Rows in the log."""
        return self.log.rows

    @property
    def lost_rows(self) -> int:
        """Rows that are not in the log: given up, or still waiting for the disk."""
        return self.log.dropped + self.log.waiting

    def setup_subscribers(self) -> None:
        """Subscribes to the topics, relative to the node's namespace."""
        self._listening = {each: Listening(self, each) for each in sources_of(self.session)}
        self.topics = {source: each.topic for source, each in self._listening.items()}

    def take(self, source: Source, message: Message) -> None:
        """Takes a message of a topic: counts it, hands it on, remarks what is odd about it."""
        topic, reception = self.topics[source], self.reception
        stamp = stamp_ns(message) if source.has_stamp else None
        reception.arrived(topic, stamp)
        remark = source.take(self.session, message, stamp or 0)
        if remark is not None and remark.left_out:
            reception.reject(topic, remark.finding)
        elif remark is not None:
            reception.remark(topic, remark.finding)
        if self.settings.debug_mode and not (remark and remark.finding == NO_POSE):
            self._debug(source, topic)

    def time_has_come(self) -> None:
        """In lock-step a row is written before anything is handled that came after its time."""
        if self.in_lock_step:
            self.timer.serve()

    def host(self, topics: Iterable[str]) -> dict[str, Callable[[int | None], None]]:
        """Takes note that a simulator in this process waits for it, whose clock is yet to begin.

        Args:
            topics: Those whose messages no executor is to serve that is given the node after this.

        Returns:
            What handles so many of the messages that have come, None for all, by topic.
        """
        self.is_hosted = self.in_lock_step = True
        self.timer.detach()
        own = {each.topic_name: each for each in self.subscriptions}
        taken = {topic: own[topic] for topic in topics}
        self._taken = tuple(taken.values())
        return {topic: taker(subscription) for topic, subscription in taken.items()}

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """Those that an executor serves."""
        return (each for each in super().subscriptions if each not in self._taken)

    def periodic_logging(self) -> None:
        """Writes a row; what a failing disk refuses waits in memory."""
        now_ns = self.get_clock().now().nanoseconds
        self.last_row = self.session.row(now_ns, self._reported_lost())
        self.log.write(self.last_row)

    def begin_spin(self) -> None:
        """Is called before an executor gets the node: unless a simulator waits, only the newest wait."""
        if not self.in_lock_step:
            self._hold(0)

    def fail(self, reason: str) -> None:
        """Takes note that the session has failed."""
        self.record.failure = reason

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Sets all of the parameters or none; also what ros2 param set comes down to."""
        reason = wrong_name_or_type(self, parameter_list)
        if reason is not None:
            return SetParametersResult(successful=False, reason=reason)
        return super().set_parameters_atomically(parameter_list)

    def destroy_node(self) -> None:
        """Closes the log, marks its end and leaves the graph."""
        if self._is_whole:
            self._end_log()
            self.timer.close()
        super().destroy_node()

    def _end_log(self) -> None:
        self.log.close()
        details = {
            "rows": self.rows,
            "segments": self.timer.times.segments,
            "topics": self.reception.account(),
            "thresholds": asdict(self.settings.thresholds),
        }
        self.record.end(self.log.path, self.lost_rows, details)

    def _hold(self, messages: int) -> None:
        for each in self._listening.values():
            each.hold(messages)

    def _reported_lost(self) -> dict[str, int]:
        remarks = self.reception.remarks
        return {source.name: remarks[topic][LOST] for source, topic in self.topics.items()}

    def _each_second(self) -> None:
        self.periodic_logging()
        follows_clock = self.get_parameter("use_sim_time").value
        clock = [self.resolve_topic_name("/clock")] if follows_clock else []
        for topic in (*self.received, *clock):
            self.reception.publishers(topic, self.count_publishers(topic))
        now_ns = self.get_clock().now().nanoseconds
        self.reception.look(now_ns, round(self.settings.stale_after * NANOSECONDS))
        self.publisher.publish(now_ns, lambda: self._statuses(now_ns))

    def _statuses(self, now_ns: int) -> list[Status]:
        assert self.last_row is not None  # noqa: S101 - a row comes first
        states = self.reception.states()
        return self._view.statuses(self.last_row, states, self.settings.thresholds, now_ns)

    def _debug(self, source: Source, topic: str) -> None:
        if self.received[topic] % self.settings.debug_interval:
            return
        m, tell = self.metrics, self.get_logger().info
        if source.name == SCAN:
            tell(f"LIDAR: clearance {m.clearance:.4f} m, total collisions {m.total_collisions}")
        elif source.name == POSE:
            tell(f"Position update: distance {m.last_step:.4f} m, total {m.total_distance:.4f} m")

    def _use_parameters(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        """Takes changed parameters into use at once, all of them or none."""
        if self.in_lock_step and any(
            each.name == "use_sim_time" and each.value is False for each in parameters
        ):
            reason = "use_sim_time stays true while a simulator waits for this node"
            return SetParametersResult(successful=False, reason=reason)
        try:
            settings = self.settings.updated({each.name: each.value for each in parameters})
            require_same_columns(self.settings, settings)
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        if self.session.extended is not None and settings.extended != self.settings.extended:
            self.session.extended.use(settings.extended)
        self.settings = settings
        self.metrics.thresholds = settings.thresholds
        self.log.fsync = settings.fsync
        self.publisher.enabled = settings.publish_metrics
        self.timer.stale_after = settings.stale_after
        return SetParametersResult(successful=True)

    def _report_received(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Answers ~/received: what arrived and what was written, as JSON."""
        remarks = {topic: dict(counts) for topic, counts in self.reception.remarks.items() if counts}
        counts = {"remarks": remarks, "rows": self.rows, "lost_rows": self.lost_rows}
        response.success = True
        response.message = json.dumps({**self.received, **counts, "log": str(self.log.path)})
        return response

    def _set_lock_step(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Answers ~/lock_step: a simulator begins to wait for this node, or does so no more."""
        was_in_lock_step, response.success = self.in_lock_step, True
        self.in_lock_step = request.data or self.is_hosted
        if request.data and HAS_EVENTS_EXECUTOR and not self.is_hosted:
            response.message = KEEPS_ORDER + HOLDS.format(AHEAD - SPARE, CLOCKS - SPARE)
            if not was_in_lock_step:
                self._hold(AHEAD)
                response.message += LISTENS_ANEW
        return response


def main(args: list[str] | None = None) -> int:
    """Runs the node, with arguments as for rclpy.init, until a signal; returns the exit code."""
    return run_node("metrics_node", MetricsNode, args)


if __name__ == "__main__":
    sys.exit(main())
