"""Command: look at the topics of this machine, as `ros2 topic` would, where there is no ros2.

    python -m harness.topics [--seconds S] [--namespace NS]

Without --seconds the table stays and changes until Ctrl-C; a short look goes on until each rate can
be told, for 8 s at most. Where there are no topics the exit code is 1. Rates are right to 2 %. It is a
look from outside: what a busy monitor misses, the others may have received. What it shows in Hz is wall
time; where a simulation sets /clock, sim Hz is what its listeners see.
"""

import argparse
import math
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from harness.base.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.topics")

from rich.console import Console
from rich.live import Live

from harness.base.errors import HarnessError, needing_ros
from harness.base.interrupt import Overdue, StopRequest
from harness.base.ros_names import namespace_of
from rover_metrics.parser import OneLineParser, positive
from rover_metrics.sheet.console import PlainConsole

if TYPE_CHECKING:
    from rclpy.executors import Executor

    from harness.ros.topic_monitor import TopicMonitor

LOOK_PERIOD = 0.5  # [s] from one look at the graph, and one table, to the next
LONG_ENOUGH = 8.0  # [s] for DDS to connect and for a rate to be measured, of a topic of 1 Hz too
SPIN_TIMEOUT = 0.1  # [s]: how long Ctrl-C may wait


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    return run_program("harness.topics", lambda: _look(options, PlainConsole()))


def _look(options: argparse.Namespace, console: Console) -> int:
    with needing_ros():
        from harness.ros.context import command_node
        from harness.ros.topic_monitor import TopicMonitor
    namespace = namespace_of(options.namespace)
    with StopRequest() as stop, command_node("topics") as (node, executor):
        _watch(TopicMonitor(node, namespace), executor, options.seconds, stop, console)
    return 0


def _watch(
    monitor: "TopicMonitor", executor: "Executor", seconds: float, stop: StopRequest, console: Console
) -> None:
    began = time.monotonic()
    end = began + seconds
    with Live(console=console, auto_refresh=False) as live:
        with suppress(Overdue), stop.deferred():
            while stop.signal is None and (time.monotonic() < end or _is_unsure(monitor, began)):
                monitor.look_around()
                live.update(monitor.table(), refresh=True)
                next_look = time.monotonic() + LOOK_PERIOD
                while stop.signal is None and time.monotonic() < next_look:
                    executor.spin_once(timeout_sec=SPIN_TIMEOUT)
        live.update(monitor.table(), refresh=True)
    if not console.is_terminal:
        console.line()  # behind the table, which Live leaves open
    if not monitor.types:
        raise HarnessError("no topics: does anything run with this ROS_DOMAIN_ID and discovery range?")


def _is_unsure(monitor: "TopicMonitor", began: float) -> bool:
    """Whether a longer look would tell more: of topics that are not found yet, or of their rates."""
    return time.monotonic() - began < LONG_ENOUGH and not (monitor.types and not monitor.too_short())


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.topics",
        description="Prints rate, age, QoS and type of each ROS 2 topic, but for rosout and "
        "parameter events.",
    )
    about = "look so long, or until rates can be told, print, end; default: until Ctrl-C"
    parser.add_argument("--seconds", type=positive, default=math.inf, metavar="S", help=about)
    parser.add_argument("--namespace", default="", metavar="NS", help="topics below it, and /clock")
    return parser


if __name__ == "__main__":
    sys.exit(main())
