"""The nodes under test, of programs or hosted: found in the graph and kept in step."""

from collections.abc import Callable, Sequence

from rclpy.executors import Executor

from harness.base.errors import HarnessError, UsageError
from harness.ros.bridge import Bridge
from harness.ros.context import nodes_beside, spin_until
from harness.ros.remote import DISCOVERY_PATIENCE
from harness.testing.process import Programs
from harness.testing.subject import Subject

START_PATIENCE = 30.0  # [s] for the nodes of a program to turn up
TOOLS = ("_", "launch_ros_")  # how the names of nodes of ros2's own tools begin


class Nodes:
    """The nodes that must have handled everything before time goes on: `subjects`, as they were added.

    Args:
        bridge: What publishes to them.
        executor: Spins it.
        programs: Those whose nodes they are, if they are not hosted here.
        time_jumps: Whether faults will set the clock back.
    """

    def __init__(
        self, bridge: Bridge, executor: Executor, programs: Programs, *, time_jumps: bool
    ) -> None:
        self._bridge, self._executor, self._programs = bridge, executor, programs
        self._time_jumps = time_jumps
        self.subjects: list[Subject] = []

    def names(self) -> set[str]:
        """Returns the full names of all nodes in the domain, but for the bridge's own."""
        return {*nodes_beside(self._bridge)}

    def wait_until(self, is_there: Callable[[], bool]) -> None:
        """Waits for nodes, at most START_PATIENCE; RunFailed if a program has ended and may not."""

        def are_there() -> bool:
            self._programs.check()
            return is_there()

        spin_until(self._executor, are_there, START_PATIENCE)

    def awaited(self, programs: Sequence[tuple[str, ...] | None]) -> tuple[str, ...]:
        """Returns the full names of the nodes of some programs, once all of them are there.

        Args:
            programs: The names of each one's nodes; None for one node of any name.

        Raises:
            RunFailed: A program has ended and may not.
            UsageError: A node has not turned up.
        """
        named = [name for nodes in programs for name in nodes or ()]
        count = programs.count(None)

        def others() -> list[str]:
            names = sorted(self.names().difference(named))
            return [name for name in names if not name.rpartition("/")[2].startswith(TOOLS)]

        def missing() -> list[str]:
            absent = [name for name in named if name not in self.names()]
            return absent + ["a node"] * (count - len(others()))

        self.wait_until(lambda: not missing())
        if missing():
            running = ", ".join(sorted(self.names())) or "none"
            patience = f"{missing()[0]} has not turned up within {START_PATIENCE:g} s"
            raise UsageError(f"launch: {patience}; running: {running}")
        return (*named, *others()[:count])

    def add(self, name: str, node: object = None) -> None:
        """Keeps a node of this full name in step from now on, as `Trial.join` does."""
        self.subjects.append(self._subject(name, node))
        self._connect()

    def renew(self) -> None:
        """Makes sure that the nodes know of the subscriptions that the bridge has made since."""
        self.subjects = [self._subject(known.name, known.node) for known in self.subjects]
        self._connect()

    def _subject(self, name: str, node: object) -> Subject:
        try:
            return Subject(name, self._bridge, self._programs, node, time_jumps=self._time_jumps)
        except HarnessError:
            self._programs.check()  # why it does not answer
            raise

    def _connect(self) -> None:
        """Waits until the bridge's subscriptions have matched the publishers that the graph shows."""
        bridge = self._bridge

        def match() -> bool:
            heard = bridge.subscriptions
            return all(s.get_publisher_count() >= bridge.count_publishers(s.topic_name) for s in heard)

        spin_until(self._executor, match, DISCOVERY_PATIENCE)
