"""A node that nobody else in its domain can end: what a handler fails of is left out and counted."""

from collections.abc import Callable
from functools import partial
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.service import Service
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

from rover_metrics.errors import shown
from rover_metrics.health.reception import Reception
from rover_metrics.health.rejections import NO_TIME
from rover_metrics.ros.parameters import BEST_EFFORT
from rover_metrics.ros.subscriptions import keep_last
from rover_metrics.topics import Message, is_time

# What the content of a message can bring about; what a signal or a shutdown raises must go through.
FAILURES = (
    *(ArithmeticError, AttributeError, LookupError, MemoryError, TypeError, ValueError),
    ParameterException,
)

# As rclpy's but for the depth: of 1, a stranger's message takes the place of the simulator's.
CLOCK_QOS = keep_last(10, BEST_EFFORT)

Handler = Callable[..., Any]


class GuardedNode(Node):  # type: ignore[misc]  # rclpy has no types for mypy
    """A Node whose subscriptions and services outlive every message and request.

    rclpy hands the exception of a handler to whoever spins, its own handlers' included: of /clock with
    negative seconds, of a parameter whose type does not exist. Timers are not guarded: they handle
    nothing of others.

    What arrived and what was left out is in the account `reception`, by resolved name.
    """

    def __init__(self, name: str, **options: Any) -> None:  # noqa: ANN401 - rclpy's
        self.reception = Reception(self._tell)
        super().__init__(name, **options)

    def create_subscription(
        self,
        msg_type: type,
        topic: str,
        callback: Handler,
        qos_profile: QoSProfile | int,
        **options: Any,  # noqa: ANN401 - rclpy's
    ) -> Subscription:
        """Creates a subscription as a Node does, and guards it; its callback takes messages alone."""
        guarded = partial(self._hear, topic, callback)
        if msg_type is Clock and not options.get("raw"):
            guarded = partial(self._hear_clock, topic, callback)
            qos_profile = CLOCK_QOS
        return super().create_subscription(msg_type, topic, guarded, qos_profile, **options)

    def time_has_come(self) -> None:
        """Is called when the node's clock shows the time of a /clock; does nothing."""

    def create_service(
        self,
        srv_type: Any,  # noqa: ANN401 - a type without types
        srv_name: str,
        callback: Handler,
        *args: Any,  # noqa: ANN401
        **kwargs: Any,  # noqa: ANN401
    ) -> Service:
        """Creates a service as a Node does, and guards it: who asks in vain gets the reason."""
        guarded = partial(self._answer, srv_name, callback)
        return super().create_service(srv_type, srv_name, guarded, *args, **kwargs)

    def _hear(self, topic: str, callback: Handler, message: Message) -> None:
        try:
            callback(message)
        except FAILURES as error:
            self._leave_out(self.resolve_topic_name(topic), error)

    def _hear_clock(self, topic: str, callback: Handler, message: Clock) -> None:
        if is_time(message.clock):
            self._hear(topic, callback, message)
        else:
            self.reception.reject(self.resolve_topic_name(topic), NO_TIME)
        self.time_has_come()

    def _answer(self, name: str, callback: Handler, request: Message, response: Message) -> Message:
        try:
            return callback(request, response)
        except FAILURES as error:
            self._leave_out(self.resolve_service_name(name), error)
            return _refused(request, response, _in_one_line(error))

    def _leave_out(self, name: str, error: Exception) -> None:
        if not self.context.ok():  # ROS was shut down under the handler
            raise error
        # What the error says stands in no counter: a stranger could make it grow without end.
        self.reception.reject(name, f"fails with {type(error).__name__}", f": {_in_one_line(error)}")

    def _tell(self, line: str) -> None:
        self.get_logger().warning(line)


def _refused(request: Message, response: Message, reason: str) -> Message:
    """What those who ask for parameters, or for a trigger, are answered; an empty answer for others."""
    refused = SetParametersResult(successful=False, reason=reason)
    if isinstance(request, SetParameters.Request):
        missing = len(request.parameters) - len(response.results)
        response.results = [*response.results, *[refused] * missing]
    elif isinstance(request, SetParametersAtomically.Request):
        response.result = refused
    elif hasattr(response, "success"):
        response.success, response.message = False, reason
    return response


def _in_one_line(error: Exception) -> str:
    return shown(" ".join(str(error).split()), 300)
