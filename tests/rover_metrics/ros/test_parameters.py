"""All parameters as they are declared, and how settings follow them; over DDS: test_metrics_node.py."""

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

from rclpy.exceptions import InvalidParameterTypeException
from rclpy.parameter import Parameter

from rover_metrics.core.thresholds import Thresholds
from rover_metrics.errors import ParameterError
from rover_metrics.extended.footprint import Footprint, LidarPose
from rover_metrics.extended.settings import ExtendedSettings, Settings
from rover_metrics.ros.parameters import (
    declare_reliability,
    declare_settings,
    require_same_columns,
    wrong_name_or_type,
)

pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")

DOUBLES = Parameter.Type.DOUBLE_ARRAY
DECLARED: dict[str, tuple[object, tuple[float, float] | None, str]] = {  # default, range, unit
    "debug_mode": (False, None, ""),
    "debug_interval": (100, (1, 1_000_000), ""),
    "log_dir": ("metrics_analyzer/data/metric_logs/", None, ""),
    "fsync": (False, None, ""),
    "stale_after": (5.0, (0.0, 86400.0), "s"),
    "publish_metrics": (True, None, ""),
    "collision_threshold": (0.2, (0.0, 100.0), "m"),
    "smoothness_threshold": (10.0, (0.0, 10000.0), "m/s^2 + rad/s"),
    "min_safe_clearance": (0.5, (0.0, 100.0), "m"),
    "distance_threshold": (0.5, (0.0, 1000.0), "m"),
    "rough_terrain_threshold": (15.0, (0.0, 10000.0), "m/s^2"),
    "extended_columns": (False, None, ""),
    "footprint": (DOUBLES, None, ""),
    "lidar_pose": ([0.0, 0.0, 0.0], None, ""),
    "near_returns_as_contact": (False, None, ""),
    "footprint_threshold": (0.05, (0.0, 100.0), "m"),
    "gravity": (9.80665, (0.0, 100.0), "m/s^2"),
    "wheels": ("front_left,rear_left,front_right,rear_right", None, ""),
}
FIXED = {"log_dir", "wheels"}
TRIANGLE = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]
CHANGES: list[tuple[str, Any, Any, Any]] = [  # value, what the settings then have, another value
    ("debug_mode", True, True, False),
    ("debug_interval", 7, 7, 8),
    ("log_dir", "/logs", "/logs", "/others"),
    ("fsync", True, True, False),
    ("stale_after", 1.5, 1.5, 2.5),
    ("publish_metrics", False, False, True),
    ("extended_columns", True, True, False),
    *((name, 0.75, 0.75, 0.25) for name in vars(Thresholds())),
    ("footprint", TRIANGLE, Footprint(((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))), []),
    ("lidar_pose", [0.1, 0.2, 0.3], LidarPose(0.1, 0.2, 0.3), [0.0, 0.0, 0.0]),
    ("near_returns_as_contact", True, True, False),
    ("footprint_threshold", 0.25, 0.25, 0.5),
    ("gravity", 9.8, 9.8, 3.7),
    ("wheels", "left,right", "left,right", "front"),
]


class Stub:
    """A node that keeps what is declared; `launch` gives values."""

    def __init__(self, **launch: object) -> None:
        self.launch = launch
        self.declared: dict[str, tuple[object, Any]] = {}
        self.parameters: dict[str, Parameter] = {}

    def declare_parameter(self, name: str, default: object, descriptor: Any) -> Parameter:  # noqa: ANN401
        self.declared[name] = default, descriptor
        value = self.launch.get(name, None if default is DOUBLES else default)
        if isinstance(value, Exception):
            raise value
        self.parameters[name] = Parameter(name, value=value)
        return self.parameters[name]

    def set_parameters(self, parameters: list[Parameter]) -> None:
        self.parameters.update({parameter.name: parameter for parameter in parameters})

    def has_parameter(self, name: str) -> bool:
        return name in self.parameters

    def describe_parameter(self, name: str) -> Any:  # noqa: ANN401
        descriptor = self.declared[name][1]
        descriptor.type = self.parameters[name].type_.value
        return descriptor


def flat(settings: Settings) -> dict[str, object]:
    """All values by the names of their parameters."""
    own = {
        name: value for name, value in vars(settings).items() if name not in ("thresholds", "extended")
    }
    return {**own, **vars(settings.thresholds), **vars(settings.extended)}


def test_every_parameter_is_declared_with_default_range_description_and_constraint() -> None:
    node = Stub()
    settings = declare_settings(node, Settings())
    assert {name: default for name, (default, _) in node.declared.items()} == {
        name: default for name, (default, *_) in DECLARED.items()
    }
    for name, (_, descriptor) in node.declared.items():
        valid = [*descriptor.floating_point_range, *descriptor.integer_range]
        bounds = [(each.from_value, each.to_value) for each in valid]
        _, valid_range, unit = DECLARED[name]
        assert bounds == [each for each in (valid_range,) if each is not None], name
        assert descriptor.description.endswith(f"[{unit}]" if unit else ""), name
        assert all(str(bound) in descriptor.additional_constraints for pair in bounds for bound in pair)
        assert descriptor.read_only is (name in FIXED)
        assert len(descriptor.description) > 20
        assert descriptor.additional_constraints
    assert settings == Settings() == declare_settings(Stub(), Settings())
    expected = {name: default for name, (default, *_) in DECLARED.items()}
    assert flat(settings) == {**expected, "footprint": None, "lidar_pose": LidarPose(0.0, 0.0, 0.0)}
    assert settings.thresholds == Thresholds()
    assert settings.extended == ExtendedSettings()


@pytest.mark.parametrize(("name", "value", "kept", "other"), CHANGES)
def test_a_value_of_the_launch_or_a_change_is_in_the_settings_and_nothing_else_is_changed(
    name: str, value: object, kept: object, other: object
) -> None:
    launched = declare_settings(Stub(**{name: value}), Settings())
    assert flat(launched) == {**flat(Settings()), name: kept}
    rest = {each: given for each, given, _, _ in CHANGES if each != name}
    full = launched.updated({**rest, "use_sim_time": True})
    assert flat(full) == {each: expected for each, _, expected, _ in CHANGES}
    again = full.updated({name: other})
    assert {each for each in flat(full) if flat(full)[each] != flat(again)[each]} == {name}
    assert full.updated({}) == full


def test_settings_given_as_a_value_are_defaults_that_the_launch_wins_over() -> None:
    given = Settings().updated({name: value for name, value, _, _ in CHANGES})
    assert declare_settings(Stub(), given) == given
    for name, _, kept, other in CHANGES:
        launched = declare_settings(Stub(**{name: other}), given)
        assert launched == given.updated({name: other})
        assert flat(launched)[name] != kept


def test_every_value_of_settings_has_the_type_that_ros_declares() -> None:
    whole = Settings(stale_after=2, thresholds=Thresholds(collision_threshold=1))
    for settings in (whole, Settings()):
        assert Settings().updated(settings.parameters) == settings
        types = {name: type(value) for name, value in settings.parameters.items()}
        assert types == {name: type(value) for name, value in Settings().parameters.items()}


@pytest.mark.parametrize("name", DECLARED)
def test_a_launch_with_a_wrong_name_or_type_is_told_the_constraint(name: str) -> None:
    wrong = InvalidParameterTypeException(Parameter(name, value="x"), "other")
    node = Stub(**{name: wrong})
    with pytest.raises(ParameterError) as caught:
        declare_settings(node, Settings())
    assert (
        str(caught.value) == f"parameter {name} must be {node.declared[name][1].additional_constraints}"
    )


def test_a_footprint_that_is_not_set_is_an_empty_list_and_one_that_is_stays() -> None:
    for launch, kept in (({}, []), ({"footprint": TRIANGLE}, TRIANGLE)):
        node = Stub(**launch)
        declare_settings(node, Settings())
        assert [*node.parameters["footprint"].value] == kept
        assert node.parameters["footprint"].type_ is DOUBLES


@pytest.mark.parametrize("now", [True, False])
def test_the_extended_columns_are_fixed_once_the_node_runs(now: bool) -> None:
    settings, wish = Settings(extended_columns=now), Settings(extended_columns=not now)
    require_same_columns(settings, settings)
    with pytest.raises(
        ParameterError, match=f"start the node with -p extended_columns:={not now}".lower()
    ):
        require_same_columns(settings, wish)


@pytest.mark.parametrize(
    ("default", "given", "value"),
    [
        ("reliable", None, "reliable"),
        ("best_effort", None, "best_effort"),
        ("reliable", "best_effort", "best_effort"),
    ],
)
def test_the_reliability_of_a_topic_is_a_fixed_parameter_of_two_values(
    default: str, given: str | None, value: str
) -> None:
    name = "qos_overrides./scan.subscription.reliability"
    node = Stub(**({} if given is None else {name: given}))
    assert declare_reliability(node, "/scan", default) == (name, value)
    assert node.declared[name][1].read_only
    with pytest.raises(
        ParameterError, match=f"parameter {name} must be reliable or best_effort, as text"
    ):
        declare_reliability(Stub(**{name: "relyable"}), "/scan", default)


def test_the_first_parameter_of_another_type_or_name_is_named() -> None:
    node = Stub()
    declare_settings(node, Settings())
    node.declare_parameter("use_sim_time", False, type(node.declared["fsync"][1])())
    fine = [Parameter(name, value=1) for name in ("use_sim_time", "debug_interval")]
    assert wrong_name_or_type(node, fine) is None
    told = wrong_name_or_type(
        node, [*fine, Parameter("stale_after", value=5), Parameter("fsync", value=1)]
    )
    valid = "a number with a decimal point (5.0, not 5) from 0.0 to 86400.0 s"
    assert told == f"parameter stale_after must be {valid}"
    for name, reason in (
        ("fsinc", "fsinc; did you mean fsync?"),
        ("qos_overrides./x", "qos_overrides./x"),
    ):
        unknown = Parameter(name, value=True)
        assert wrong_name_or_type(node, [unknown, *fine]) == f"there is no parameter {reason}"
