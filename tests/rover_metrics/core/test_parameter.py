"""What is told of a parameter, and which numbers are refused."""

import math
from dataclasses import dataclass

import pytest

from rover_metrics.core.parameter import parameter, parameters_of, require_ranges
from rover_metrics.errors import ParameterError


@dataclass(frozen=True)
class Some:
    """Settings with parameters, and something else."""

    share: float = parameter(0.5, "a share", minimum=0.25, maximum=1.0)
    count: int = parameter(3, "a count", minimum=1, maximum=9, unit="m")
    free: float = parameter(1.0, "any number", example="1.5, not 2")
    corners: tuple[float, ...] | None = parameter(None, "corners", ros_default=(), valid="a list")
    is_on: bool = parameter(False, "a switch", read_only=True)
    other: float = math.nan


@pytest.mark.parametrize(
    ("name", "default", "constraint"),
    [
        ("share", 0.5, "a number with a decimal point (1.0, not 1) from 0.25 to 1.0"),
        ("count", 3, "an integer from 1 to 9 m"),
        ("free", 1.0, "a number with a decimal point (1.5, not 2) from 0.0 to inf"),
        ("corners", (), "a list"),
        ("is_on", False, "true or false, not 0 or 1"),
    ],
)
def test_a_parameter_tells_its_default_and_what_is_valid(
    name: str, default: object, constraint: str
) -> None:
    infos = parameters_of(Some)
    assert list(infos) == ["share", "count", "free", "corners", "is_on"]
    assert (infos[name].default, infos[name].constraint) == (default, constraint)
    assert [each for each, info in infos.items() if info.read_only] == ["is_on"]
    assert Some().corners is None


def test_numbers_outside_their_closed_range_are_refused_and_others_have_none() -> None:
    for some in (Some(), Some(share=0.25, count=1), Some(share=1.0, count=9, free=-1e300)):
        require_ranges(some)
    for some, told in (
        (Some(share=0.2), r"share = 0\.2 is not valid: it must be from 0\.25 to 1\.0$"),
        (Some(share=math.nan), "share = nan"),
        (Some(count=0), "count = 0 is not valid: it must be from 1 to 9 m"),
        (Some(count=10), "count = 10"),
    ):
        with pytest.raises(ParameterError, match=told):
            require_ranges(some)
