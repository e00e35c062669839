"""A ROS node as a program: one line for a known mistake, a clean end on SIGINT and SIGTERM."""

import sys
from collections.abc import Callable
from contextlib import ExitStack

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

from rover_metrics.errors import RoverMetricsError, StartError
from rover_metrics.ros.arguments import complaint, refusal


def run_node(name: str, make_node: Callable[[], Node], args: list[str] | None) -> int:
    """Runs a node until SIGINT or SIGTERM.

    Args:
        name: What the program is called.
        make_node: Makes the node, once ROS is up; its `fail` takes why its session has failed.
        args: Command line as for rclpy.init; sys.argv if None.

    Returns:
        Exit code: 0 after a clean end, 2 after a known mistake, told in one line on stderr.
    """
    try:
        _run(make_node, args)
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except RoverMetricsError as error:
        print(f"{name}: {error}", file=sys.stderr)
        return error.exit_code
    return 0


def _run(make_node: Callable[[], Node], args: list[str] | None) -> None:
    with ExitStack() as at_end:
        wrong = complaint(sys.argv if args is None else args)
        if wrong is not None:
            raise StartError(wrong)
        try:
            rclpy.init(args=args)
        except RuntimeError as error:
            raise StartError(refusal(error)) from error
        at_end.callback(rclpy.try_shutdown)
        try:
            executor = SingleThreadedExecutor()
            at_end.callback(executor.shutdown)
            node = make_node()
            at_end.callback(node.destroy_node)
            executor.add_node(node)
            _spin(executor, node)
        except (RuntimeError, AttributeError):
            # A signal at start-up pulls the context from under whatever rclpy call is running.
            if rclpy.ok():
                raise


def _spin(executor: SingleThreadedExecutor, node: Node) -> None:
    try:
        executor.spin()
    except ExternalShutdownException:
        raise
    except Exception as error:
        if rclpy.ok():
            node.fail(f"{type(error).__name__}: {error}")
        raise
