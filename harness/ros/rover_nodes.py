"""The nodes of one rover, in a run and in a trial alike: bridge, navigation, hosted MetricsNode."""

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from functools import partial

from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.logging import get_logger
from rclpy.parameter import Parameter

from harness.base.errors import UsageError
from harness.episode.assembly import injector, scenery
from harness.episode.result import Outputs, RunResult, TopicCount, cells_of
from harness.episode.stream import RoverOrders
from harness.episode.topics import outlets_of, painter
from harness.robots import find_rover
from harness.robots.frames.tree import Description
from harness.ros.bridge import Bridge
from harness.ros.channel import Channel
from harness.ros.commands import RCLError
from harness.ros.hosted import HostedMetrics
from harness.ros.navigation import Navigation
from harness.samples import Twist
from harness.spec.run import Run
from rover_metrics.errors import RoverMetricsError
from rover_metrics.metrics_node import MetricsNode
from rover_metrics.ros.arguments import refusal


def metrics_node(context: Context, outputs: Outputs, namespace: str = "") -> MetricsNode:
    """Returns a MetricsNode on simulation time.

    Args:
        context: The rclpy context that the node lives in.
        outputs: The folder of its log, whatever the command line says, and the defaults of its
            parameters, over which `--ros-args` wins.
        namespace: Namespace of the node and of what it listens to, where there are several rovers.

    Raises:
        UsageError: The log cannot be created, or a parameter on the command line is not valid.
    """
    try:
        str(outputs.log_dir.absolute()).encode()
    except UnicodeEncodeError as error:  # os.fsdecode's of bytes
        mend = "which texts of ROS are; name another, or leave ROS out with --direct"
        raise UsageError(f"the folder {outputs.log_dir} has a name that is no UTF-8, {mend}") from error
    values = {"use_sim_time": True, "log_dir": str(outputs.log_dir)}
    given = [Parameter(name, value=value) for name, value in values.items()]
    settings = outputs.settings
    try:
        return MetricsNode(settings, context=context, parameter_overrides=given, namespace=namespace)
    except RoverMetricsError as error:
        raise UsageError(str(error)) from error


def _end(node: MetricsNode, error: type[BaseException] | None, *_: object) -> None:
    """Ends a node; of a run that is refused, which has no row, no log is left."""
    node.destroy_node()
    if error is not None and issubclass(error, UsageError) and not node.rows:
        for file in (node.log.path, node.log.path.with_suffix(".json")):
            file.unlink(missing_ok=True)


class RoverNodes:
    """The nodes of one rover.

    Args:
        run: What is driven.
        number: The rover's place in it.
        on_command: Is given each command that is heard.
        at_end: Ends the nodes.
        cmd_vel: How commands come, as `Bridge` says.
        context: Of rclpy; the default one if None.
        clock: /clock, if the bridge of another rover publishes it.

    Attributes:
        bridge: Publishes the samples and hears the commands.
        faults: What of the rover's samples reaches the listeners.
        navigation: Serves /map, /initialpose and /goal_pose, after `navigate`.
        hosted: The MetricsNode in this process; None without one.
    """

    def __init__(
        self,
        run: Run,
        number: int,
        on_command: Callable[[Twist], None],
        at_end: ExitStack,
        *,
        cmd_vel: str = "twist",
        context: Context | None = None,
        clock: Channel | None = None,
    ) -> None:
        self.run, self.number = run, number
        self.setup = setup = run.rovers[number]
        self._context, self._at_end = context, at_end
        self._painter = at_end.enter_context(painter(run, number, get_logger("harness").warning))
        try:
            self.bridge = Bridge(
                find_rover(setup.robot),
                outlets_of(run, number, self._painter.image),
                context=context,
                on_command=on_command,
                cmd_vel=cmd_vel,
                namespace=setup.name,
                clock=clock,
            )
        except RCLError as error:  # of names that are remapped
            raise UsageError(f"ROS 2 refuses the node harness: {refusal(error)}") from error
        at_end.callback(self.bridge.destroy_node)
        self.faults = injector(run, number)
        self.hosted: HostedMetrics | None = None

    def begin_anew(self, run: Run) -> None:
        """Shows another run from now on, of the same rover with the same sensors in another world."""
        self.run = run
        self._painter.use(partial(scenery, run), run.own_seed(self.number))

    def navigate(self, orders: RoverOrders, *, truth_map: bool) -> None:
        """Serves what a navigation stack asks for, and hands its orders on."""
        of = self.bridge, self.run, self.number, orders
        self.navigation = Navigation(*of, truth_map=truth_map)

    def host_metrics(self, executor: Executor, outputs: Outputs) -> None:
        """Starts a MetricsNode and waits until DDS has connected it.

        Raises:
            UsageError: DDS does not connect it, or its log cannot be created.
        """
        node = metrics_node(self._context, outputs, self.setup.name)
        self._at_end.push(partial(_end, node))
        self.hosted = HostedMetrics(self.bridge, node)
        executor.add_node(node)
        self.hosted.await_match()

    def begin(self, description: Description | None) -> None:
        """Refuses other publishers of the rover's topics and publishes its fixed frames, if it has any.

        Raises:
            UsageError: A topic has a second publisher.
        """
        self.bridge.refuse_other_publishers(self.hosted.topics if self.hosted else ())
        if description is not None:
            self.bridge.describe(description)

    def look_around(self) -> None:
        """Hears publishers and serves listeners that have turned up since the last look."""
        self.bridge.commands.look_around()
        self.navigation.look_around()

    @property
    def listeners(self) -> tuple[HostedMetrics, ...]:
        """The hosted MetricsNode, if there is one."""
        return () if self.hosted is None else (self.hosted,)

    def topics(self) -> dict[str, TopicCount]:
        """Returns how many messages of each topic have been published."""
        return {topic: TopicCount(count) for topic, count in self.bridge.published().items()}

    def rows(self) -> int:
        """Returns how many rows the log of the hosted MetricsNode has."""
        return 0 if self.hosted is None else self.hosted.node.rows

    def logged(self, result: RunResult) -> RunResult:
        """Returns a result with what the hosted MetricsNode adds: rows, thresholds, reception."""
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
