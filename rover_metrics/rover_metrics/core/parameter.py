"""What a ROS parameter is: the one source of its declaration, validation, files and documentation.

A frozen dataclass of settings defines its fields with `parameter`; `parameters_of` returns their table.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Any, TypeVar

from rover_metrics.errors import ParameterError

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class ParameterInfo:
    """One parameter; the type of its default is its own."""

    default: Any  # as ROS has it; an empty tuple is a list of numbers that is not set
    description: str
    unit: str = ""  # of its numbers; empty if the description states it
    minimum: float = 0.0  # the smallest valid number
    maximum: float = math.inf  # the largest; infinite for what is no number
    example: str = "1.0, not 1"  # how a number is to be written, and how not
    valid: str = ""  # what is valid, if type and range do not say it
    read_only: bool = False  # fixed once the node runs

    @property
    def valid_range(self) -> str:
        """Returns the closed interval of valid numbers, with their unit."""
        return f"from {self.minimum} to {self.maximum} {self.unit}".rstrip()

    @property
    def constraint(self) -> str:
        """Returns what is valid, to follow "must be"."""
        kinds = {
            bool: "true or false, not 0 or 1",
            int: f"an integer {self.valid_range}",
            float: f"a number with a decimal point ({self.example}) {self.valid_range}",
        }
        return self.valid or kinds[type(self.default)]


def parameter(default: T, description: str, *, ros_default: object = None, **facts: Any) -> T:  # noqa: ANN401
    """Returns the definition of a dataclass field that is a parameter.

    Args:
        default: Default of the field.
        description: What it means.
        ros_default: The default as ROS has it, where that differs.
        facts: The other attributes of its ParameterInfo.
    """
    value = default if ros_default is None else ros_default
    info = ParameterInfo(default=value, description=description, **facts)
    defined: T = field(default=default, metadata={"info": info})
    return defined


def parameters_of(settings: type) -> Mapping[str, ParameterInfo]:
    """Returns the parameters among the fields of a dataclass, by name."""
    there = {each.name: each.metadata["info"] for each in fields(settings) if each.metadata}
    return MappingProxyType(there)


def require_ranges(settings: object) -> None:
    """Raises a ParameterError if a number among the parameters is outside its range, or not a number."""
    for name, info in parameters_of(type(settings)).items():
        value = getattr(settings, name)
        if info.maximum < math.inf and not info.minimum <= value <= info.maximum:
            raise ParameterError(f"{name} = {value} is not valid: it must be {info.valid_range}")
