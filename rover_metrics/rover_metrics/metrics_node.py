"""MetricsNode: subscriptions, parameters, a timer. Adapts messages to TraversalMetrics, no more."""

import json
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rover_metrics.errors import (
    LogError,
    ParameterError,
    RoverMetricsError,
    StartError,
    missing_ros,
)

try:
    import rclpy
    from geometry_msgs.msg import PoseArray
    from nav_msgs.msg import Odometry
    from rcl_interfaces.msg import SetParametersResult
    from rclpy.context import Context
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.node import Node
    from rclpy.parameter import Parameter
    from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import Imu, LaserScan
    from std_srvs.srv import Trigger

    from rover_metrics.parameters import Settings, declare_settings, wrong_type
except ImportError as error:
    raise missing_ros(error) from None

from rover_metrics.csv_log import CsvLog
from rover_metrics.metrics import TraversalMetrics

if TYPE_CHECKING:
    from rover_metrics.row import MetricsRow

LOG_PERIOD = 1.0  # seconds of ROS time

RELIABLE = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=10,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)
# Only the newest pose matters; reliable delivery would queue old ones.
LATEST_ONLY = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.VOLATILE,
)


class MetricsNode(Node):  # type: ignore[misc]  # rclpy has no types for mypy
    """Logs the traversal metrics of a rover once per second of ROS time.

    Args:
        context: The rclpy context; the default one if None.
        parameter_overrides: Parameter values as a launch would give them.
        now: Wall clock for the name of the log.

    Attributes:
        settings: The current parameter values.
        metrics: The metrics of this session.
        log: The CSV log of this session.
        received: Messages received, by resolved topic name.
        rejected: Those of them that were left out because a value was not finite or missing.
        lost_rows: Rows that could not be written.
        last_row: The latest row, written or not; None before the first.

    Raises:
        ParameterError: A parameter was given a value that is not valid.
        LogError: The log cannot be created.
    """

    def __init__(
        self,
        *,
        context: Context | None = None,
        parameter_overrides: list[Parameter] | None = None,
        now: Callable[[], datetime] = datetime.now,
    ) -> None:
        super().__init__("metrics_node", context=context, parameter_overrides=parameter_overrides)
        try:
            self.settings: Settings = declare_settings(self)
            self.log = CsvLog(Path(self.settings.log_dir).expanduser(), now())
        except RoverMetricsError:
            super().destroy_node()
            raise
        self.metrics = TraversalMetrics(self.settings.thresholds)
        self.received: dict[str, int] = {}
        self.rejected: dict[str, int] = {}
        self.lost_rows = 0
        self.last_row: MetricsRow | None = None
        self.add_on_set_parameters_callback(self._use_parameters)
        self.setup_subscribers()
        self.create_service(Trigger, "~/received", self._report_received)
        self.create_timer(LOG_PERIOD, self.periodic_logging)
        self.get_logger().info(f"logging to: {self.log.path.parent}/")

    @property
    def rows(self) -> int:
        """Rows in the log."""
        return self.log.rows

    def setup_subscribers(self) -> None:
        """Subscribe to the four sensor topics, relative to the node's namespace."""
        self._scan = self._subscribe(LaserScan, "scan", self.lidar_callback, RELIABLE)
        self._imu = self._subscribe(Imu, "imu/data", self.imu_callback, RELIABLE)
        self._pose = self._subscribe(
            PoseArray, "rover/pose_array", self.pose_array_callback, LATEST_ONLY
        )
        self._odometry = self._subscribe(Odometry, "odometry/wheels", self.odometry_callback, RELIABLE)

    def lidar_callback(self, scan: LaserScan) -> None:
        """Take a scan; one without a finite range is open space, not a fault."""
        self.received[self._scan] += 1
        self.metrics.add_scan(scan.ranges)
        if self._debug_is_due(self._scan):
            self.get_logger().info(
                f"LIDAR: clearance {self.metrics.clearance:.4f} m, "
                f"total collisions {self.metrics.total_collisions}"
            )

    def imu_callback(self, imu: Imu) -> None:
        """Take an IMU sample."""
        self.received[self._imu] += 1
        a, w = imu.linear_acceleration, imu.angular_velocity
        if not self.metrics.add_imu((a.x, a.y, a.z), (w.x, w.y, w.z)):
            self._reject(self._imu)

    def pose_array_callback(self, poses: PoseArray) -> None:
        """Take the first pose, which is the rover's."""
        self.received[self._pose] += 1
        position = poses.poses[0].position if poses.poses else None
        if position is None or not self.metrics.add_pose((position.x, position.y, position.z)):
            self._reject(self._pose)
        if self._debug_is_due(self._pose):
            self.get_logger().info(
                f"Position update: distance {self.metrics.last_step:.4f} m, "
                f"total {self.metrics.total_distance:.4f} m"
            )

    def odometry_callback(self, odometry: Odometry) -> None:
        """Take a wheel odometry sample."""
        self.received[self._odometry] += 1
        v = odometry.twist.twist.linear
        if not self.metrics.add_odometry((v.x, v.y, v.z)):
            self._reject(self._odometry)

    def periodic_logging(self) -> None:
        """Write the row of this second; a failing disk costs rows, not the session."""
        self.last_row = self.metrics.row(self.get_clock().now().to_msg().sec)
        try:
            self.log.write(self.last_row)
        except LogError as error:
            self.lost_rows += 1
            if _is_power_of_two(self.lost_rows):
                self.get_logger().error(f"{error} ({self.lost_rows} rows lost so far)")

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set all of the parameters or none; also what ros2 param set comes down to."""
        reason = wrong_type(self, parameter_list)
        if reason is not None:
            return SetParametersResult(successful=False, reason=reason)
        return super().set_parameters_atomically(parameter_list)

    def destroy_node(self) -> None:
        """Close the log and leave the graph."""
        self.log.close()
        super().destroy_node()

    def _subscribe(
        self, message_type: type, name: str, callback: Callable[[Any], None], qos: QoSProfile
    ) -> str:
        """Subscribe and start counting; gives the topic's resolved name."""
        topic: str = self.create_subscription(message_type, name, callback, qos).topic_name
        self.received[topic] = self.rejected[topic] = 0
        return topic

    def _debug_is_due(self, topic: str) -> bool:
        return self.settings.debug_mode and self.received[topic] % self.settings.debug_interval == 0

    def _reject(self, topic: str) -> None:
        """Count a sample that was left out, and say so at the 1st, 2nd, 4th, 8th ... of a topic."""
        self.rejected[topic] += 1
        if _is_power_of_two(self.rejected[topic]):
            self.get_logger().warning(
                f"{topic}: empty or not finite, left out ({self.rejected[topic]} so far)"
            )

    def _use_parameters(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        """Take changed parameters into use at once, all of them or none."""
        try:
            self.settings = self.settings.updated(parameters)
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        self.metrics.thresholds = self.settings.thresholds
        return SetParametersResult(successful=True)

    def _report_received(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Answer ~/received: what arrived and what was written, as JSON."""
        response.success = True
        response.message = json.dumps({**self.received, "rows": self.rows, "log": str(self.log.path)})
        return response


def main(args: list[str] | None = None) -> int:
    """Run the node until SIGINT or SIGTERM.

    Args:
        args: Command line as for rclpy.init; sys.argv if None.

    Returns:
        Exit code: 0 after a clean end, 2 after a known mistake, told in one line on stderr.
    """
    try:
        _run(args)
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except RoverMetricsError as error:
        print(f"metrics_node: {error}", file=sys.stderr)
        return error.exit_code
    return 0


def _run(args: list[str] | None) -> None:
    with ExitStack() as at_end:
        try:
            rclpy.init(args=args)
        except RuntimeError as error:
            raise StartError(" ".join(str(error).split())) from error
        at_end.callback(rclpy.try_shutdown)
        try:
            executor = SingleThreadedExecutor()
            at_end.callback(executor.shutdown)
            node = MetricsNode()
            at_end.callback(node.destroy_node)
            executor.add_node(node)
            executor.spin()
        except (RuntimeError, AttributeError):
            # A signal at start-up pulls the context from under whatever rclpy call is running.
            if rclpy.ok():
                raise


def _is_power_of_two(number: int) -> bool:
    return number & (number - 1) == 0


if __name__ == "__main__":
    sys.exit(main())
