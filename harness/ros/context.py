"""The rclpy context of a command, and the executor that spins its nodes.

EventsExecutor handles a message in a third of the time of the wait-set executors and serves every
queued message, not one per round. Its spin() hangs on signals and its ROS-time timers miscount when
flooded (docs/design.md), so the harness only ever calls spin_once, from one loop with a bounded wait,
and lets simulation time go on when everything is handled. Humble has none; the standard one serves.
"""

import gc
import math
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stderr
from traceback import clear_frames
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from harness.base.errors import UsageError
from harness.ros.network import stay_local
from rover_metrics.ros.arguments import refusal
from rover_metrics.ros.guarded_node import GuardedNode

try:
    from rclpy.experimental import EventsExecutor
except ImportError:
    EventsExecutor = SingleThreadedExecutor

QUIET = 0.2  # [s] of wall time in which nothing new is discovered, before a run begins
SPIN_TIMEOUT = 0.1  # [s]: how long one spin may block; a stop request is answered between two
SPINS = 5  # in a control period as a rule: a tenth of a millisecond each
NOTICED = 0.005  # [s] of wall time that others cannot tell from what a message takes to them
LONGEST_SPIN = 1.0  # [s] of patience that one may take: who was stopped longer has yet to look what came


@contextmanager
def ros_context(ros_args: Sequence[str]) -> Iterator[Context]:
    """Yields a local context of this run's own that leaves signals to the command; shut down at the end.

    Raises:
        UsageError: ROS 2 refuses the arguments or the environment.
    """
    stay_local()
    context = Context()
    no_handlers = SignalHandlerOptions.NO
    try:
        rclpy.init(args=list(ros_args), context=context, signal_handler_options=no_handlers)
    except RuntimeError as error:
        raise UsageError(f"ROS 2 refuses to start: {refusal(error)}") from error
    try:
        with unfinished_is_freed():
            yield context
    finally:
        context.try_shutdown()


@contextmanager
def unfinished_is_freed() -> Iterator[None]:
    """Frees what was being made within when an exception came: a signal may raise anywhere in rclpy.

    The exception's frames and a half made node's cycles would keep it, and DDS with it, whose files in
    shared memory then outlive the process.
    """
    try:
        yield
    except BaseException as error:
        raised: BaseException | None = error
        while raised is not None:
            clear_frames(raised.__traceback__)
            raised = raised.__context__
        gc.collect()
        raise


def make_executor(context: Context, *, time_jumps: bool = False) -> Executor:
    """Returns the fastest executor there is; EventsExecutor may call a timer twice where time jumps."""
    kind = SingleThreadedExecutor if time_jumps else EventsExecutor
    # It asks stderr for its file, which one that keeps a text (pytest --capture=sys) has not.
    with redirect_stderr(sys.__stderr__ or sys.stderr):
        return kind(context=context)


@contextmanager
def command_node(name: str) -> Iterator[tuple[Node, Executor]]:
    """Yields a node of a command in a context of its own, and the executor that spins it.

    Raises:
        UsageError: ROS 2 refuses the environment.
    """
    with ros_context([]) as context, make_executor(context) as executor:
        node = GuardedNode(f"{name}_{os.getpid()}", context=context, enable_rosout=False)
        executor.add_node(node)
        yield node, executor


def owner_of(endpoint: Any) -> str:  # noqa: ANN401 - rclpy has no types
    """Returns the full name of the node that has a publisher or a subscription of the graph."""
    return f"{endpoint.node_namespace.rstrip('/')}/{endpoint.node_name}"


def nodes_beside(node: Node) -> list[str]:
    """Returns the full names of all other nodes of the graph."""
    return sorted({*node.get_fully_qualified_node_names()} - {node.get_fully_qualified_name()})


def not_found(node: Node, wanted: str) -> UsageError:
    """Returns what to raise where a node does not see the one that is wanted: it names those it sees."""
    others = ", ".join(nodes_beside(node)) or "none (same ROS_DOMAIN_ID and discovery range?)"
    return UsageError(f"node {wanted} was not found; running: {others}")


class Interval:
    """Says whether some wall time has passed since it last said so; the first time it has.

    Args:
        seconds: The wall time [s].
        clock: Monotonic wall clock [s].
    """

    def __init__(self, seconds: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._seconds, self._clock, self._since = seconds, clock, -math.inf

    def is_over(self) -> bool:
        """Returns whether the time has passed; then the next interval begins."""
        if (now := self._clock()) < self._since + self._seconds:
            return False
        self._since = now
        return True


def serve_waiting(executor: Executor) -> None:
    """Serves all that has come by now, in a tenth of the 80 us that an idle `spin_once` takes.

    Subscriptions and services that are new are served from the next time on. A SingleThreadedExecutor,
    which serves tasks before all else, serves SPINS of what has come.
    """
    if isinstance(executor, SingleThreadedExecutor):
        for _ in range(SPINS):
            executor.spin_once(timeout_sec=0.0)
        return
    served: list[bool] = []
    executor.create_task(served.append, True)  # behind all that has come
    while not served:
        executor.spin_once(timeout_sec=0.0)


def spin_until(executor: Executor, condition: Callable[[], bool], patience: float) -> bool:
    """Spins until a condition holds; returns whether it did.

    Args:
        executor: To be spun.
        condition: What is waited for.
        patience: How long at most [s].
    """
    since = time.monotonic()
    while not condition():
        if patience < 0.0:
            return False
        executor.spin_once(timeout_sec=SPIN_TIMEOUT)
        before, since = since, time.monotonic()
        patience -= min(since - before, LONGEST_SPIN)
    return True


def spin_until_quiet(
    executor: Executor,
    look: Callable[[], object],
    quiet: float,
    patience: float,
    now: Callable[[], float] = time.monotonic,
) -> None:
    """Spins until what is looked at has not changed for a while.

    Args:
        executor: To be spun.
        look: Returns what may change.
        quiet: How long it must not [s].
        patience: How long to spin at most [s].
        now: Wall clock [s].
    """
    began = since = now()
    seen = look()
    while now() - since < quiet and now() - began < patience:
        executor.spin_once(timeout_sec=min(quiet, SPIN_TIMEOUT))
        if (present := look()) != seen:
            seen, since = present, now()
