"""A ROS node as a program: one line for a known mistake, a clean end on SIGINT and SIGTERM.

While a simulator keeps lock-step with the node, EventsExecutor spins it, which handles a message in a
third of the time, and in the order of its arrival. Its ROS-time timers miscount where /clock floods it
or goes back, so that it is only for a simulator that waits and has said so.
"""

import gc
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from pathlib import Path

import rclpy
from rclpy._rclpy_pybind11 import RCLError
from rclpy.exceptions import NameValidationException
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future

try:
    from rclpy.experimental import EventsExecutor
except ImportError:  # Humble, Jazzy
    EventsExecutor = SingleThreadedExecutor

from rover_metrics.errors import RoverMetricsError
from rover_metrics.ros.arguments import check_words, complaint, refusal

HAS_EVENTS_EXECUTOR = EventsExecutor is not SingleThreadedExecutor
SPIN_TIMEOUT = 0.2  # [s]: how long one spin may block; a signal is answered between two


def run_node(name: str, make_node: Callable[[], Node], args: list[str] | None) -> int:
    """Runs a node until SIGINT or SIGTERM; returns 0, or 2 after a known mistake, which prints one line.

    Args:
        name: What the program is called.
        make_node: Makes the node, once ROS is up; its `fail` takes why its session has failed, its
            `in_lock_step` says whether a simulator waits for it, and its `begin_spin` is called
            before an executor gets it.
        args: Command line as for rclpy.init; sys.argv if None.
    """
    try:
        _run(name, make_node, args)
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except RoverMetricsError as error:
        print(f"{name}: {error}", file=sys.stderr)
        return error.exit_code
    finally:
        gc.collect()  # a node that a signal left half made: DDS' files in shared memory would outlive it
    return 0


def _run(name: str, make_node: Callable[[], Node], args: list[str] | None) -> None:
    with ExitStack() as at_end:
        words = sys.argv[1:] if args is None else args
        check_words(name, words)
        wrong = complaint(words)
        if wrong is not None:
            raise RoverMetricsError(wrong)
        at_end.enter_context(started(args))
        # Executors outlive the node: a signal's own thread may still be at work on what wakes them.
        executors = at_end.enter_context(ExitStack())
        try:
            node = make_node()
        except (NameValidationException, RCLError) as error:
            if not rclpy.ok():
                raise
            raise RoverMetricsError(f"{refusal(error)}; give another name") from error
        at_end.callback(node.destroy_node)
        _spin(node, executors)


@contextmanager
def started(args: Sequence[str] | None) -> Iterator[None]:
    """Within, ROS is up; what fails because a signal has shut it down ends it quietly.

    Raises:
        RoverMetricsError: ROS refuses these arguments, or the environment; the message says why.
    """
    try:
        rclpy.init(args=args)
    except RuntimeError as error:
        raise RoverMetricsError(f"ROS 2 refuses to start: {refusal(error)}") from error
    try:
        yield
    except (RuntimeError, AttributeError):
        # A signal pulls the context from under whatever rclpy call is running.
        if rclpy.ok():
            raise
    finally:
        rclpy.try_shutdown()


def _spin(node: Node, executors: ExitStack) -> None:
    try:
        while rclpy.ok():
            _spin_by_one_executor(node, executors, in_lock_step=node.in_lock_step)
    except ExternalShutdownException:
        raise
    except Exception as error:
        if rclpy.ok():
            node.fail(f"{type(error).__name__}: {error}")
        raise


def _spin_by_one_executor(node: Node, executors: ExitStack, *, in_lock_step: bool) -> None:
    """Returns when the node's lock-step has begun or ended, or ROS is shut down."""
    executor = executors.enter_context(EventsExecutor() if in_lock_step else SingleThreadedExecutor())
    node.begin_spin()
    executor.add_node(node)
    with _giving_way() if in_lock_step else nullcontext():
        by_events = in_lock_step and HAS_EVENTS_EXECUTOR
        spin(executor, lambda: node.in_lock_step is in_lock_step, by_events=by_events)
    if rclpy.ok():
        executors.close()  # another one follows


@contextmanager
def _giving_way() -> Iterator[None]:
    """Within, no thread of this process, DDS' included, interrupts whoever wakes it.

    A simulator that runs ahead goes on undisturbed, and more is there to be handled in one go. Does
    nothing on other systems than Linux, and to a process to which somebody has given another policy.
    """
    may = hasattr(os, "SCHED_BATCH") and os.sched_getscheduler(0) == os.SCHED_OTHER
    if may:
        _change_policy(os.SCHED_OTHER, os.SCHED_BATCH)
    try:
        yield
    finally:
        if may:
            _change_policy(os.SCHED_BATCH, os.SCHED_OTHER)


def _change_policy(before: int, after: int) -> None:
    """Gives another scheduling policy to those threads of this process that have a certain one."""
    for thread in Path("/proc/self/task").glob("*"):
        with suppress(OSError):  # it has ended, or this is forbidden
            if os.sched_getscheduler(int(thread.name)) == before:
                os.sched_setscheduler(int(thread.name), after, os.sched_param(0))


def spin(
    executor: Executor, goes_on: Callable[[], bool] = lambda: True, *, by_events: bool = False
) -> None:
    """Spins until ROS is shut down, by a signal for instance, or something says that it does not go on.

    `rclpy.spin` may block for ever after a signal: rclpy wakes whoever waits first and shuts its context
    down afterwards: who is quick finds ROS up and waits again. EventsExecutor is not woken at all.

    Args:
        executor: Has the node.
        goes_on: Is asked before each spin.
        by_events: Whether it is an EventsExecutor, which handles what comes within SPIN_TIMEOUT in one
            spin: with a return from each callback, lock-step takes 8 % longer.

    Raises:
        ExternalShutdownException: ROS was shut down within a spin.
    """
    while executor.context.ok() and goes_on():
        if by_events:
            executor.spin_until_future_complete(Future(), SPIN_TIMEOUT)
        else:
            executor.spin_once(timeout_sec=SPIN_TIMEOUT)
