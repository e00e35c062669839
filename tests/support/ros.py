"""Nodes in a domain of the test's own, as a run has them."""

from contextlib import ExitStack
from typing import Any

from tests.support.waiting import PATIENCE

Untyped = Any  # rclpy has no types
ANSWER = 2.0  # [s] until a request is sent again


class Ros:
    """A context with its executor, and what tests make of nodes in it."""

    def __init__(self, at_end: ExitStack, *ros_args: str) -> None:
        from harness.ros.context import make_executor, ros_context  # noqa: PLC0415 - see `ros`

        self.at_end = at_end
        self.context: Untyped = at_end.enter_context(ros_context(ros_args))
        self._clients: dict[str, Untyped] = {}
        self.executor: Untyped = at_end.enter_context(make_executor(self.context))

    def node(self, name: str) -> Untyped:
        """A node that the executor spins."""
        import rclpy  # noqa: PLC0415 - see `ros`

        return self.added(rclpy.create_node(name, context=self.context, enable_rosout=False))

    def bridge(self, **options: Any) -> Untyped:  # noqa: ANN401 - those of a Bridge
        """A bridge of a leo that the executor spins."""
        from rclpy.logging import LoggingSeverity  # noqa: PLC0415 - see `ros`

        from harness.messages.outlets import outlets  # noqa: PLC0415
        from harness.robots.lidar import LidarSpec  # noqa: PLC0415
        from harness.ros.bridge import Bridge  # noqa: PLC0415
        from harness.sensors.choice import chosen  # noqa: PLC0415 - needs more than rover_metrics
        from tests.support.rovers import LEO  # noqa: PLC0415

        told = outlets(LEO, LidarSpec(beams=4), chosen(LEO, ()))
        bridge = Bridge(LEO, told, context=self.context, **options)
        bridge.get_logger().set_level(LoggingSeverity.INFO)  # whatever ran in this process before
        return self.added(bridge)

    def added(self, node: Untyped) -> Untyped:
        """A node, once the executor spins it."""
        self.at_end.callback(node.destroy_node)
        self.executor.add_node(node)
        return node

    def until(self, condition: Any) -> None:  # noqa: ANN401 - a function
        """Spins until a condition holds, which must be soon."""
        from harness.ros.context import spin_until  # noqa: PLC0415 - see `ros`

        assert spin_until(self.executor, condition, PATIENCE)

    def ask(self, node: Untyped, kind: Untyped, service: str, **request: Any) -> Untyped:  # noqa: ANN401
        """The answer that a node gets to a request."""
        if service not in self._clients:
            self._clients[service] = node.create_client(kind, service)
            self.until(self._clients[service].service_is_ready)
        asked: list[Untyped] = []
        while True:  # an answer is lost while the server does not know this client yet, or it comes late
            asked.append(self._clients[service].call_async(kind.Request(**request)))
            self.executor.spin_until_future_complete(asked[-1], timeout_sec=ANSWER)
            for future in asked:
                if future.done():
                    return future.result()
