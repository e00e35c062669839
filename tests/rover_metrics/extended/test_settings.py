"""What is refused before a node has a value, by names alone; nodes are in ros/test_parameters.py."""

import pytest

from rover_metrics.errors import ParameterError
from rover_metrics.extended.settings import PARAMETERS, Settings, check_name


def test_a_name_is_one_of_the_parameters_one_of_every_node_or_a_mistake() -> None:
    assert all(check_name(name, may_be_others=False) for name in PARAMETERS)
    for name in ("use_sim_time", "start_type_description_service"):
        assert check_name(name, may_be_others=False) is False
    for name in ("rough_terain_threshold", "rough_threshold"):
        with pytest.raises(ParameterError, match="rough_terrain_threshold"):
            check_name(name, may_be_others=True)
    assert check_name("threshold", may_be_others=True) is False
    for name, nearest in (("Gravity", "gravity"), ("use_sim_tim", "use_sim_time")):
        with pytest.raises(ParameterError, match=rf"no parameter {name}; did you mean {nearest}\?"):
            check_name(name, may_be_others=False)


def test_the_defaults_that_ros_declares_are_those_of_the_settings() -> None:
    assert Settings().updated({name: info.default for name, info in PARAMETERS.items()}) == Settings()


def test_a_value_that_is_no_name_or_out_of_range_is_refused() -> None:
    assert Settings().updated({"debug_mode": True, "nobodys": "", "log_dir": " "}).log_dir == " "
    for values, told in (
        ({"log_dir": ""}, "log_dir must be the path of a folder, not empty text"),
        ({"gravity": -5e-324}, r"gravity = -5e-324 .* from 0\.0 to 100\.0 m"),
        ({"footprint_threshold": 100.1}, r"footprint_threshold = 100.1 .* from 0\.0 to 100\.0 m"),
    ):
        with pytest.raises(ParameterError, match=told):
            Settings().updated(values)
