"""Command: call a service of this machine, or set a parameter, where there is no ros2 command.

    python -m harness.call                          # which services there are
    python -m harness.call /harness/pause true
    python -m harness.call /metrics_node set collision_threshold 0.3

Calls services of std_srvs: Trigger and Empty, which ask nothing, and SetBool, which asks true or false.
"""

import argparse
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from harness.base.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.call")

from harness.base.errors import RunFailed, UsageError, needing_ros
from harness.base.interrupt import StopRequest
from rover_metrics.errors import sibling
from rover_metrics.parser import OneLineParser

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node

PATIENCE = 5.0  # [s] for services to be found, and for an answer
LOOK = 1.0  # [s] in which no other service was found: then all were
TYPES = ("std_srvs/srv/Trigger", "std_srvs/srv/Empty", "std_srvs/srv/SetBool")
SET_BOOL = TYPES[-1]
SET = "set"


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 1 if the service says no or nothing."""
    options = _parser().parse_args(arguments)
    return run_program("harness.call", lambda: _main(options))


def _main(options: argparse.Namespace) -> int:
    with needing_ros():
        from harness.ros.context import command_node
    with StopRequest(), command_node("call") as (node, executor):
        if options.value == SET:
            return _set(node, executor, options)
        return (_list if options.service is None else _call)(node, executor, options)


def _set(node: "Node", executor: "Executor", options: argparse.Namespace) -> int:
    from harness.ros.node_parameters import set_parameter

    if len(options.parameter) != 2:
        raise UsageError(f"give {options.service} set PARAM VALUE, e.g. set collision_threshold 0.3")
    remote, (name, text) = f"/{options.service.lstrip('/')}", options.parameter
    print(set_parameter(node, executor, remote, name, text, PATIENCE))
    return 0


def _list(node: "Node", executor: "Executor", _: argparse.Namespace) -> int:
    services = _find(node, executor, None)
    for name, kind in sorted(services.items()):
        print(f"{name}  {kind}")
    if not services:
        raise RunFailed("no services: does anything run with this ROS_DOMAIN_ID and discovery range?")
    return 0


def _call(node: "Node", executor: "Executor", options: argparse.Namespace) -> int:
    from harness.ros.context import spin_until

    if options.parameter:
        raise UsageError(
            f"leave out '{options.parameter[0]}': a parameter is set with NODE set PARAM VALUE"
        )
    name = f"/{options.service.lstrip('/')}"
    services = _find(node, executor, name)
    if name not in services:
        raise UsageError(
            f"there is no service {name}; available: {', '.join(sorted(services)) or 'none'}"
        )
    kind, request = _request(services[name], name, options.value)
    client = node.create_client(kind, name)
    future = None
    if spin_until(executor, client.service_is_ready, PATIENCE):
        future = client.call_async(request)
        spin_until(executor, future.done, PATIENCE)
    if future is None or not future.done():
        raise RunFailed(f"{name} did not answer within {PATIENCE:g} s")
    answer = future.result()
    print(getattr(answer, "message", "") or "done")
    return 0 if getattr(answer, "success", True) else 1


def _find(node: "Node", executor: "Executor", wanted: str | None) -> dict[str, str]:
    """The services that can be called, by name; waits for the wanted one, or for any."""
    from harness.ros.context import spin_until, spin_until_quiet

    services: dict[str, str] = {}

    def look() -> bool:
        known = node.get_service_names_and_types()
        services.update((name, kinds[0]) for name, kinds in known if kinds[0] in TYPES)
        return wanted in services if wanted else bool(services)

    is_found = spin_until(executor, look, PATIENCE)
    if is_found and wanted is None:  # others may be found later than the first
        spin_until_quiet(executor, lambda: look() and len(services), LOOK, PATIENCE)
    return services


def _request(kind: str, name: str, value: str | None) -> tuple[Any, Any]:
    """The class of a service, and what is asked of it."""
    import std_srvs.srv

    service = getattr(std_srvs.srv, kind.rpartition("/")[2])
    if kind != SET_BOOL:
        if value is not None:
            raise UsageError(f"{name} asks nothing; leave out '{value}'")
        return service, service.Request()
    if value not in ("true", "false"):
        raise UsageError(f"{name} asks true or false: {sibling('harness.call')} {name} true")
    return service, service.Request(data=value == "true")


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.call",
        description="Calls a service of std_srvs (Trigger, Empty, SetBool) and prints its answer; "
        "without a name, prints which there are. NODE set PARAM VALUE sets a parameter.",
        epilog="Exit code 0: it says yes. 1: no, or nothing. 2: there is no such service.",
    )
    parser.add_argument(
        "service", nargs="?", metavar="SERVICE", help="e.g. /harness/reset; default: list"
    )
    about = "what SetBool asks for; or set: then SERVICE is a node"
    parser.add_argument("value", nargs="?", metavar="true|false|set", help=about)
    about = "of the node, and its new value, of lists with commas; default: none"
    parser.add_argument("parameter", nargs="*", metavar="PARAM VALUE", help=about)
    return parser


if __name__ == "__main__":
    sys.exit(main())
