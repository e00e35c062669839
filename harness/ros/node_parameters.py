"""A parameter of a node that runs, set from its text as the type that it has there."""

from collections.abc import Callable
from typing import Any

from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient

from harness.base.errors import RunFailed, UsageError, unknown
from harness.ros.context import not_found, spin_until
from rover_metrics.number import number

ATTEMPTS = 2  # an answer is lost where the server has not found who asked yet
BOOLS = {"true": True, "false": False}
Kind = Parameter.Type
SINGLE: dict[Any, tuple[Callable[[str], Any], str]] = {
    Kind.BOOL: (BOOLS.__getitem__, "true or false"),
    Kind.INTEGER: (int, "a whole number"),
    Kind.DOUBLE: (number, "a number"),
    Kind.STRING: (str, "text"),
}
LISTS = {
    Kind.BOOL_ARRAY: Kind.BOOL,
    Kind.INTEGER_ARRAY: Kind.INTEGER,
    Kind.DOUBLE_ARRAY: Kind.DOUBLE,
    Kind.STRING_ARRAY: Kind.STRING,
}


def set_parameter(
    node: Node, executor: Executor, remote: str, name: str, text: str, patience: float
) -> str:
    """Sets a parameter; returns what it is then.

    Args:
        node: Asks.
        executor: Spins it.
        remote: Full name of the node that has the parameter.
        name: Of the parameter.
        text: Its new value; of lists, elements with commas between them.
        patience: How long to wait for an answer [s].

    Raises:
        UsageError: There is no such node or parameter, or that is no value of it.
        RunFailed: The node does not answer, or refuses the value.
    """
    client = AsyncParameterClient(node, remote)
    if not spin_until(executor, client.services_are_ready, patience):
        raise not_found(node, remote)

    def answered(ask: Callable[[], Any]) -> Any:  # noqa: ANN401 - rclpy's have no types
        for _ in range(ATTEMPTS):
            if spin_until(executor, (future := ask()).done, patience / ATTEMPTS):
                return future.result()
        raise RunFailed(f"{remote} did not answer within {patience:g} s")

    present = answered(lambda: client.get_parameters([name])).values
    kind = Kind(present[0].type) if present else Kind.NOT_SET
    if kind not in SINGLE and kind not in LISTS:
        names = answered(client.list_parameters).result.names
        raise UsageError(unknown("parameter", name, names))
    value = _value(name, kind, text)
    (result,) = answered(lambda: client.set_parameters([Parameter(name, kind, value)])).results
    if not result.successful:
        raise RunFailed(f"{remote} refuses {name} {text}: {result.reason or 'no reason given'}")
    return f"{remote} {name} is {value}"


def _value(name: str, kind: Any, text: str) -> Any:  # noqa: ANN401 - of whatever type it has
    """The value that a text is of a parameter of a kind; UsageError if it is none."""
    convert, form = SINGLE[LISTS.get(kind, kind)]
    try:
        return [convert(word) for word in text.split(",")] if kind in LISTS else convert(text)
    except (ValueError, KeyError) as error:
        form = f"{form}, or several with commas" if kind in LISTS else form
        raise UsageError(f"{name} '{text}' is not valid; give {form}") from error
