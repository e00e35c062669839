"""The node under test: hosted in this process or started as one of its own, kept in lock-step."""

import signal
import subprocess
from collections.abc import Sequence
from typing import Any

from rclpy.executors import Executor

from harness.errors import RunFailed
from harness.ros.bridge import Bridge
from harness.ros.context import SPIN_TIMEOUT, spin_until
from harness.ros.remote import DISCOVERY_PATIENCE, RemoteNode

EXIT_PATIENCE = 5.0  # [s] for a node to leave after SIGINT before it is killed


class Subject:
    """A node that must have handled everything before time goes on; a Listener.

    Args:
        name: Its fully qualified name.
        bridge: What publishes to it.
        executor: Spins the bridge, and the node if it is hosted.
        node: The rclpy node if it is hosted.
    """

    def __init__(self, name: str, bridge: Bridge, executor: Executor, node: Any = None) -> None:  # noqa: ANN401
        self._name, self._bridge, self._executor, self._node = name, bridge, executor, node
        self.connect()

    def connect(self) -> None:
        """Waits until the node knows every subscription that was made here before.

        DDS announces a participant's endpoints in order: a node that answers a new client has heard of
        what is older than that client.

        Raises:
            UsageError: There is no such node, or it runs on wall time.
        """
        self._remote = RemoteNode(self._name, self._bridge, self._executor)

    def wait_for_samples(self) -> None:
        """Returns when the node has handled its queue, and everybody here what it then published."""
        self._remote.wait_for_samples()

    def wait_for_clock(self, stamp_ns: int) -> None:
        """Returns when its timers have run too."""
        self._remote.wait_for_clock(stamp_ns)
        while self._timer_is_due():
            self._executor.spin_once(timeout_sec=SPIN_TIMEOUT)
        self._remote.wait_for_clock(stamp_ns)

    def _timer_is_due(self) -> bool:
        if self._node is None:
            return False
        clock = self._node.get_clock()
        return any(timer.clock is clock and timer.is_ready() for timer in self._node.timers)


def started(command: Sequence[str], environment: dict[str, str]) -> "subprocess.Popen[bytes]":
    """Starts a node's process; its output goes where this process's goes."""
    return subprocess.Popen(list(command), env=environment)


def await_node(
    process: "subprocess.Popen[bytes]", name: str, bridge: Bridge, executor: Executor
) -> None:
    """Waits until a started node is there.

    Raises:
        RunFailed: Its process has ended instead.
    """

    def is_there() -> bool:
        nodes = bridge.get_node_names_and_namespaces()
        return process.poll() is not None or name in {f"{space.rstrip('/')}/{n}" for n, space in nodes}

    spin_until(executor, is_there, DISCOVERY_PATIENCE)
    if process.poll() is not None:
        raise RunFailed(f"the process of {name} ended at its start with exit code {process.returncode}")


def stop(process: "subprocess.Popen[bytes]") -> None:
    """Ends a node's process as Ctrl-C does, or else by force."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.wait(EXIT_PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
