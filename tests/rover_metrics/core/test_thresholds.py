import dataclasses
import math
import re

import pytest

from rover_metrics.core.parameter import ParameterInfo
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, THRESHOLD_INFO, Thresholds
from rover_metrics.errors import ParameterError

VALID = {  # RoboTerrain's default; the largest value and the unit of docs/metrics.md
    "collision_threshold": (0.2, 100.0, "m"),
    "smoothness_threshold": (10.0, 10000.0, "m/s^2 + rad/s"),
    "min_safe_clearance": (0.5, 100.0, "m"),
    "distance_threshold": (0.5, 1000.0, "m"),
    "rough_terrain_threshold": (15.0, 10000.0, "m/s^2"),
}


def test_thresholds_have_roboterrains_defaults_and_a_described_range_from_zero() -> None:
    assert dataclasses.asdict(Thresholds()) == {name: default for name, (default, _, _) in VALID.items()}
    assert Thresholds() == DEFAULT_THRESHOLDS
    assert list(THRESHOLD_INFO) == list(VALID)
    for info, (default, maximum, unit) in zip(THRESHOLD_INFO.values(), VALID.values(), strict=True):
        described = (info.default, info.minimum, info.maximum, info.unit)
        assert described == (default, 0.0, maximum, unit)
        assert info.valid_range == f"from 0.0 to {maximum} {unit}"
        assert info.description
    assert ParameterInfo(default=1.0, description="a share").valid_range == "from 0.0 to inf"


@pytest.mark.parametrize("name", VALID)
def test_a_range_is_closed_and_what_is_outside_is_refused_with_name_value_and_range(name: str) -> None:
    default, maximum, unit = VALID[name]
    for value in (0.0, default, maximum):
        assert getattr(Thresholds(**{name: value}), name) == value
    told = re.escape(f" is not valid: it must be from 0.0 to {maximum} {unit}")
    for value in (-5e-324, math.nextafter(maximum, math.inf), math.inf, math.nan):
        with pytest.raises(ParameterError, match=f"^{name} = {value}{told}$"):
            Thresholds(**{name: value})
