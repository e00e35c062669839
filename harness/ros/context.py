"""The rclpy context of a command: local, and without handlers of signals."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import rclpy
from rclpy.context import Context
from rclpy.signals import SignalHandlerOptions

from harness.errors import UsageError
from harness.ros.locality import stay_local


@contextmanager
def ros_context(ros_args: Sequence[str]) -> Iterator[Context]:
    """A context of this run's own that leaves signals to the command; shut down at the end.

    Raises:
        UsageError: ROS 2 refuses the arguments or the environment.
    """
    stay_local()
    context = Context()
    try:
        rclpy.init(
            args=list(ros_args),
            context=context,
            signal_handler_options=SignalHandlerOptions.NO,
        )
    except RuntimeError as error:
        message = f"ROS 2 refuses to start: {' '.join(str(error).split())}"
        raise UsageError(message) from error
    try:
        yield context
    finally:
        context.try_shutdown()
