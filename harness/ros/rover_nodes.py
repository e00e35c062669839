"""The nodes of one rover in a run: the bridge, what follows its goals, the hosted MetricsNode."""

from contextlib import ExitStack
from dataclasses import replace

from rclpy.context import Context
from rclpy.executors import Executor

from harness.episode.assembly import actor_names, injector, sensor_rows
from harness.episode.result import Outputs, RunResult, TopicCount, cells_of
from harness.episode.stream import RoverOrders
from harness.frames.tree import Description
from harness.robots import find_rover
from harness.ros.bridge import Bridge, Listener
from harness.ros.camera import painter
from harness.ros.channel import Channel
from harness.ros.hosted import HostedMetrics, metrics_node
from harness.ros.navigation import Navigation
from harness.sensors.lidar_spec import LidarSpec
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from rover_metrics.ros.metrics_publisher import MetricsPublisher


class RoverNodes:
    """The nodes of one rover.

    Args:
        run: What is driven.
        number: The rover's place in the run.
        outputs: Where its data go.
        options: How the run goes through ROS.
        orders: Of the rover.
        clock: /clock, if another one tells it.
    """

    def __init__(
        self,
        run: Run,
        number: int,
        outputs: Outputs,
        options: RosOptions,
        orders: RoverOrders,
        context: Context,
        at_end: ExitStack,
        clock: Channel | None,
    ) -> None:
        self.run, self.number, self.outputs = run, number, outputs
        self.setup = setup = run.rovers[number]
        self.orders, self._context, self._at_end = orders, context, at_end
        draw = at_end.enter_context(painter(run, number)).image
        self.bridge = Bridge(
            find_rover(setup.robot),
            LidarSpec(beams=setup.lidar_beams),
            context=context,
            on_command=orders.command,
            cmd_vel=options.cmd_vel,
            rows=sensor_rows(setup),
            draw=draw,
            actors=actor_names(run.world),
            namespace=setup.name,
            clock=clock,
        )
        at_end.callback(self.bridge.destroy_node)
        self.faults = injector(run, number)
        self.hosted: HostedMetrics | None = None

    def join(self, executor: Executor) -> None:
        """Has the bridge spun."""
        executor.add_node(self.bridge)
        self.navigation = Navigation(self.bridge, self.run, self.number, self.orders)

    def host_metrics(self, executor: Executor) -> None:
        """Starts its MetricsNode."""
        node = metrics_node(
            self._context, self.outputs.log_dir, self.setup.name, settings=self.outputs.settings
        )
        self._at_end.callback(node.destroy_node)
        executor.add_node(node)
        self.hosted = HostedMetrics(self.bridge, node)
        self.hosted.await_match()

    def begin(self, description: Description | None) -> None:
        """Refuses other publishers of its topics, and publishes what its transforms are of, if known."""
        self.bridge.refuse_other_publishers(self.hosted.topics if self.hosted else ())
        if description is not None:
            self.bridge.describe(description)

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
