"""The nodes of one rover in a run: the bridge, what follows its goals, the hosted MetricsNode."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace

from rclpy.context import Context
from rclpy.executors import Executor

from harness.config import RosOptions
from harness.episode.loop import injector
from harness.episode.result import RoverRun, RunResult, TopicCount, cells_of
from harness.episode.stream import RoverOrders
from harness.robots import find_rover
from harness.ros.bridge import Bridge, Listener
from harness.ros.camera import painter
from harness.ros.channel import Channel
from harness.ros.hosted import HostedMetrics, metrics_node
from harness.ros.navigation import Navigation
from harness.sensors.lidar_spec import LidarSpec
from rover_metrics.ros.metrics_publisher import MetricsPublisher


class RoverNodes:
    """The nodes of one rover.

    Args:
        number: Its place among the rovers.
        run: What it is asked for, and likewise all others.
        options: How the run goes through ROS.
        orders: Of the rover.
        clock: /clock, if another one tells it.
    """

    def __init__(
        self,
        number: int,
        run: Sequence[RoverRun],
        options: RosOptions,
        orders: RoverOrders,
        context: Context,
        at_end: ExitStack,
        clock: Channel | None,
    ) -> None:
        self.asked = run[number]
        self.config = config = self.asked.config
        self.orders, self._context, self._at_end = orders, context, at_end
        draw = at_end.enter_context(painter(config, [rover.config for rover in run])).image
        self.bridge = Bridge(
            find_rover(config.robot),
            LidarSpec(beams=config.lidar_beams),
            context=context,
            on_command=orders.command,
            cmd_vel=options.cmd_vel,
            rows=config.sensor_rows(),
            draw=draw,
            actors=config.actor_names(),
            namespace=config.name,
            clock=clock,
        )
        at_end.callback(self.bridge.destroy_node)
        self.faults = injector(config)
        self.hosted: HostedMetrics | None = None

    def join(self, executor: Executor) -> None:
        """Has the bridge spun."""
        executor.add_node(self.bridge)
        self.navigation = Navigation(self.bridge, self.config, self.orders)

    def host_metrics(self, executor: Executor) -> None:
        """Starts its MetricsNode."""
        asked = self.asked
        node = metrics_node(self._context, asked.log_dir, self.config.name, asked.parameters)
        self._at_end.callback(node.destroy_node)
        executor.add_node(node)
        self.hosted = HostedMetrics(self.bridge, node)
        self.hosted.await_match()

    @property
    def metrics(self) -> MetricsPublisher | None:
        """What the hosted metrics_node publishes with."""
        return None if self.hosted is None else self.hosted.node.publisher

    @property
    def listeners(self) -> tuple[Listener, ...]:
        """The hosted metrics_node, if there is one."""
        return () if self.hosted is None else (self.hosted,)

    def topics(self) -> dict[str, TopicCount]:
        """Returns how many messages have been published."""
        return {topic: TopicCount(count) for topic, count in self.bridge.published().items()}

    def rows(self) -> int:
        """Returns how many rows are in its log."""
        return 0 if self.hosted is None else self.hosted.node.rows

    def logged(self, result: RunResult) -> RunResult:
        """Returns a result with what its metrics_node has to say."""
        if self.hosted is None:
            return result
        node, failure = self.hosted.node, result.failure
        node.log.close()  # what waits for the disk is tried a last time, then it is lost
        if failure is None and node.lost_rows:
            failure = f"{node.lost_rows} rows could not be written"
        return replace(
            result,
            failure=failure,
            rows=node.rows,
            log_path=node.log.path,
            last_row=cells_of(node.last_row),
            thresholds=node.settings.thresholds,
            reception=node.reception.account(),
            segments=node.timer.times.segments,
        )
