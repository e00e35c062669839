"""The executor that spins the harness's nodes, always from one loop with a bounded wait.

EventsExecutor handles a message in a third of the time of the wait-set executors and serves every
queued message, not one per round. Its spin() hangs on signals and its ROS-time timers miscount when
flooded (docs/design.md), so the harness only ever calls spin_once and lets
simulation time go on when everything is handled. Humble has none: there the standard one serves.
"""

import time
from collections.abc import Callable

from rclpy.context import Context
from rclpy.executors import Executor, SingleThreadedExecutor

try:
    from rclpy.experimental import EventsExecutor
except ImportError:
    EventsExecutor = SingleThreadedExecutor

SPIN_TIMEOUT = 0.1  # [s]: how long one spin may block; a stop request is answered between two


def make_executor(context: Context, *, time_jumps: bool = False) -> Executor:
    """The fastest executor that this rclpy has and that serves timers rightly.

    Args:
        context: Of the nodes that will be added.
        time_jumps: Whether ROS time will go back: then EventsExecutor may call a timer twice.
    """
    kind = SingleThreadedExecutor if time_jumps else EventsExecutor
    return kind(context=context)


def spin_until(executor: Executor, condition: Callable[[], bool], patience: float) -> bool:
    """Spins until a condition holds; False if it does not after `patience` seconds."""
    deadline = time.monotonic() + patience
    while not condition():
        if time.monotonic() > deadline:
            return False
        executor.spin_once(timeout_sec=SPIN_TIMEOUT)
    return True
