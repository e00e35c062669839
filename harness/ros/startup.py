"""What must stand before a run can begin: the hosted node, connected topics, no strangers."""

from pathlib import Path

from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.parameter import Parameter

from harness.errors import UsageError
from harness.ros.bridge import Bridge
from harness.ros.executor import spin_until
from harness.ros.lockstep import SECOND_PUBLISHER
from rover_metrics.errors import RoverMetricsError
from rover_metrics.metrics_node import MetricsNode

MATCH_PATIENCE = 15.0  # [s] for DDS to match the topics of this process


def metrics_node(context: Context, log_dir: Path) -> MetricsNode:
    """A MetricsNode on simulation time that logs into a folder.

    Raises:
        UsageError: The log cannot be created, or a parameter on the command line is not valid.
    """
    overrides = [
        Parameter("use_sim_time", value=True),
        Parameter("log_dir", value=str(log_dir)),
    ]
    try:
        return MetricsNode(context=context, parameter_overrides=overrides)
    except RoverMetricsError as error:
        raise UsageError(str(error)) from error


def await_match(bridge: Bridge, executor: Executor, topics: tuple[str, ...]) -> None:
    """Waits until each of these topics, and /clock, has its listener.

    Raises:
        UsageError: DDS does not connect them.
    """
    needed = (*topics, bridge.clock_channel.topic)
    channels = [channel for channel in bridge.channels if channel.topic in needed]
    if not spin_until(
        executor,
        lambda: all(c.publisher.get_subscription_count() for c in channels),
        MATCH_PATIENCE,
    ):
        alone = [c.topic for c in channels if not c.publisher.get_subscription_count()]
        message = (
            f"DDS did not connect {', '.join(alone)} within {MATCH_PATIENCE:.0f} s; "
            "is ROS_AUTOMATIC_DISCOVERY_RANGE=OFF set, or a firewall on the loopback device?"
        )
        raise UsageError(message)


def refuse_other_publishers(bridge: Bridge, topics: tuple[str, ...]) -> None:
    """Another harness or simulator would mix into the log; what starts later is caught in lock-step.

    Raises:
        UsageError: One of these topics, or /clock, has a second publisher.
    """
    for topic in (*topics, bridge.clock_channel.topic):
        if bridge.count_publishers(topic) > 1:
            raise UsageError(f"{topic} {SECOND_PUBLISHER}")
