"""A node that nobody else in its domain can end: messages that a handler fails on are counted."""

from collections import Counter
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

from rover_metrics.errors import ParameterError, shown
from rover_metrics.health.reception import Reception
from rover_metrics.health.rejections import NO_TIME
from rover_metrics.plugins import blamed
from rover_metrics.ros.arguments import refusal
from rover_metrics.ros.decoding import decoded
from rover_metrics.ros.parameters import BEST_EFFORT
from rover_metrics.ros.subscriptions import keep_last
from rover_metrics.topics import Message, is_time

IN_A_ROW = 3  # messages of a topic on which a plug-in fails: it fails on each, and no row is written
CLOCKS = 100  # messages of /clock that may wait: a second of them at 100 Hz

# What the content of a message can bring about; what a signal or a shutdown raises must go through.
FAILURES = (
    *(ArithmeticError, AttributeError, LookupError, MemoryError, TypeError, ValueError),
    ParameterException,
)

# As rclpy's but for the depth: with 1, a foreign message takes the place of the simulator's.
CLOCK_QOS = keep_last(CLOCKS, BEST_EFFORT)

Handler = Callable[..., Any]


class GuardedNode(Node):  # type: ignore[misc]  # rclpy has no types for mypy
    """A Node whose subscriptions and services outlive every message and request.

    rclpy hands a handler's exception to the caller of spin, its own handlers' included: of /clock with
    negative seconds, of a parameter whose type does not exist. Timers are not guarded: they handle
    nothing of others.

    What arrived and what was left out is in the account `reception`, by resolved name; `clocks` counts
    the messages of /clock that told a time.
    """

    def __init__(self, name: str, **options: Any) -> None:  # noqa: ANN401 - rclpy's
        """Joins the graph; raises a ParameterError if the command line sets one to what it cannot be."""
        self.reception, self.clocks = Reception(self._tell), 0
        self._failing: Counter[str] = Counter()  # messages in a row on which a plug-in has failed
        try:
            super().__init__(name, **options)
        except ParameterException as error:  # of a parameter that rclpy declares, all of them switches
            raise ParameterError(f"{refusal(error)}; give true or false") from error

    def create_subscription(
        self,
        msg_type: type,
        topic: str,
        callback: Handler,
        qos_profile: QoSProfile | int,
        **options: Any,  # noqa: ANN401 - rclpy's
    ) -> Subscription:
        """Creates a subscription as a Node does, and guards it; its callback takes messages alone."""
        if not options.pop("raw", False):
            if msg_type is Clock:
                callback, qos_profile = partial(self._take_time, topic, callback), CLOCK_QOS
            else:
                callback = partial(_decode, msg_type, callback)
        # Bytes of no such message are bytes too: rclpy's C code prints a line for each of them.
        patience = 1 if msg_type is Clock else IN_A_ROW  # with a time comes a row, which is lost
        guarded = partial(self._hear, topic, callback, patience=patience)
        return super().create_subscription(msg_type, topic, guarded, qos_profile, raw=True, **options)

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
        """Creates a service as a Node does, and guards it: a refused request gets the reason."""
        guarded = partial(self._answer, srv_name, callback)
        return super().create_service(srv_type, srv_name, guarded, *args, **kwargs)

    def destroy_node(self) -> None:
        """Leaves the graph, with a line for each topic and service of which something was left out."""
        for name, count in self.reception.rejected.items():
            if count > 1:  # one was reported
                self._tell(f"{name}: {count} left out in all")
        super().destroy_node()

    def _hear(self, topic: str, callback: Handler, data: bytes, *, patience: int = IN_A_ROW) -> None:
        try:
            callback(data)
        except FAILURES as error:
            if blamed(error):
                self._failing[topic] += 1
                if self._failing[topic] == patience:
                    raise
            self._leave_out(self.resolve_topic_name(topic), error)
        else:
            if self._failing:
                self._failing.pop(topic, None)

    def _take_time(self, topic: str, callback: Handler, data: bytes) -> None:
        message = decoded("rosgraph_msgs/msg/Clock", Clock, data)
        try:
            if is_time(message.clock):
                self.clocks += 1
                callback(message)
            else:
                self.reception.reject(self.resolve_topic_name(topic), NO_TIME)
        finally:
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
        # The error's text is no counter's name: foreign messages could make them grow without end.
        self.reception.reject(name, f"fails with {type(error).__name__}", f": {_in_one_line(error)}")

    def _tell(self, line: str) -> None:
        self.get_logger().warning(line)


def _decode(kind: type, callback: Handler, data: bytes) -> None:
    """Gives a whole message to its callback; ValueError if the bytes are of none."""
    callback(decoded(kind.__name__, kind, data))


def _refused(request: Message, response: Message, reason: str) -> Message:
    """The answer to a refused request for parameters or for a trigger; an empty one to others."""
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
