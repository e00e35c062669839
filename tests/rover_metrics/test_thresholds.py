import dataclasses
import math

import pytest

from rover_metrics.errors import ThresholdError
from rover_metrics.thresholds import THRESHOLD_INFO, Thresholds


def test_defaults_are_the_seeds() -> None:
    assert dataclasses.asdict(Thresholds()) == {
        "collision_threshold": 0.2,
        "smoothness_threshold": 10.0,
        "min_safe_clearance": 0.5,
        "distance_threshold": 0.5,
        "rough_terrain_threshold": 15.0,
    }


def test_every_threshold_is_described_with_a_unit() -> None:
    assert list(THRESHOLD_INFO) == [field.name for field in dataclasses.fields(Thresholds)]
    assert all(info.unit and info.description for info in THRESHOLD_INFO.values())


@pytest.mark.parametrize("name", THRESHOLD_INFO)
def test_the_bounds_of_a_range_are_valid(name: str) -> None:
    info = THRESHOLD_INFO[name]
    for value in (info.minimum, info.maximum, info.default):
        assert getattr(Thresholds(**{name: value}), name) == value


@pytest.mark.parametrize("name", THRESHOLD_INFO)
@pytest.mark.parametrize("value", [-0.001, 10001.0, math.inf, -math.inf, math.nan])
def test_a_value_outside_its_range_is_rejected_with_name_value_and_range(
    name: str, value: float
) -> None:
    with pytest.raises(ThresholdError) as caught:
        Thresholds(**{name: value})
    message = str(caught.value)
    assert f"{name} = {value}" in message
    assert THRESHOLD_INFO[name].valid_range in message
    assert THRESHOLD_INFO[name].unit in message
    assert "\n" not in message


def test_thresholds_do_not_change_in_place() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        Thresholds().collision_threshold = 0.3  # type: ignore[misc]
