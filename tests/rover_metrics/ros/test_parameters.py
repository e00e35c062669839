"""The parameters of a real node: declared, described, set by settings and launch, changed."""

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient

from rover_metrics.errors import ParameterError
from rover_metrics.extended.parameter_file import read_values
from rover_metrics.extended.settings import PARAMETERS, Settings
from tests.rover_metrics.conftest import TRIANGLE, VALUES, Rig

RELIABILITY = "qos_overrides./scan.subscription.reliability"
FIXED = ("log_dir", "pose_queue", "wheels", "energy", "soil", "columns", "extended_columns")


def told(node: Any) -> dict[str, Any]:  # noqa: ANN401 - rclpy has no types
    """What `ros2 param dump` shows of the settings, lists as lists."""
    values = {name: node.get_parameter(name).value for name in PARAMETERS}
    return {name: value if isinstance(value, str) else _listed(value) for name, value in values.items()}


def _listed(value: Any) -> Any:  # noqa: ANN401
    return [*value] if hasattr(value, "__len__") else value


def test_every_parameter_is_declared_as_the_table_says_and_all_can_be_read_at_once(rig: Rig) -> None:
    node = rig.start()
    for name, info in PARAMETERS.items():
        descriptor = node.describe_parameter(name)
        assert descriptor.description.startswith(info.description)
        assert descriptor.description.endswith(f"[{info.unit}]" if info.unit else "")
        assert descriptor.additional_constraints == info.constraint
        assert descriptor.read_only is (name in FIXED[:-1])
        valid = [*descriptor.floating_point_range, *descriptor.integer_range]
        bounds = [(each.from_value, each.to_value) for each in valid]
        is_number = type(info.default) in (int, float)
        assert bounds == ([(info.minimum, info.maximum)] if is_number else [])
    assert told(node) == {**Settings().parameters, "log_dir": str(rig.folder)}
    client = AsyncParameterClient(rig.simulator, "metrics_node")
    rig.spin_until(client.services_are_ready)
    future = client.get_parameters([*node._parameters])
    rig.spin_until(future.done)
    assert len(future.result().values) == len(node._parameters)


def test_values_of_the_launch_are_the_settings_and_can_be_changed_one_by_one(rig: Rig) -> None:
    node = rig.start(**VALUES)
    expected = Settings(log_dir=str(rig.folder)).updated(VALUES)
    assert (node.settings, told(node)) == (expected, expected.parameters)
    for name, value in Settings().parameters.items():
        before, kind = node.settings, node.get_parameter(name).type_
        outcome = node.set_parameters_atomically([Parameter(name, kind, value)])
        assert outcome.successful is (name not in FIXED), outcome.reason
        after = before if name in FIXED else before.updated({name: value})
        assert node.settings == after
    assert (node.log.fsync, node.publisher.enabled, node.timer.stale_after) == (False, True, 5.0)
    assert node.metrics.thresholds == Settings().thresholds


def test_settings_given_as_a_value_are_defaults_that_the_launch_wins_over(rig: Rig) -> None:
    given = Settings().updated(VALUES)
    words = ("-p", "collision_threshold:=0.3", "-p", "footprint:=[0.0, 0.0, 2.0, 0.0, 0.0, 2.0]")
    node = rig.start(*words, settings=given, gravity=3.7)
    wins = {"collision_threshold": 0.3, "footprint": [2 * x for x in TRIANGLE], "gravity": 3.7}
    expected = given.updated({**wins, "log_dir": str(rig.folder)})
    assert (node.settings, told(node)) == (expected, expected.parameters)
    assert node.session.metrics.thresholds == expected.thresholds
    assert "True Slip Right" in node.session.columns


def test_values_of_settings_have_the_types_that_ros_declares_and_lead_back_to_the_settings() -> None:
    whole = Settings().updated({"stale_after": 2, "collision_threshold": 1, "gravity": 3})
    for settings in (whole, Settings(), Settings().updated(VALUES)):
        assert Settings().updated(settings.parameters) == settings
        types = {name: type(value) for name, value in settings.parameters.items()}
        assert types == {name: type(value) for name, value in Settings().parameters.items()}


def test_a_launch_with_a_value_that_is_not_valid_says_what_is(rig: Rig) -> None:
    wrong = [(name, "x" if type(info.default) is not str else 3) for name, info in PARAMETERS.items()]
    odd = [("rough_terrain_threshold", float("nan")), ("debug_interval", 0), ("stale_after", 5)]
    for name, value in (*wrong, *odd):
        given: dict[str, Any] = {name: value}
        with pytest.raises(ParameterError) as refused:
            rig.start(**given)
        assert str(refused.value) == f"parameter {name} must be {PARAMETERS[name].constraint}"
    assert list(rig.folder.iterdir()) == []


def test_the_reliability_of_a_topic_is_a_fixed_parameter_of_two_values(rig: Rig) -> None:
    with pytest.raises(ParameterError, match=f"{RELIABILITY} must be reliable or best_effort, as text"):
        rig.start("-p", f"{RELIABILITY}:=relyable")


SECTIONS = (  # of the node, in one namespace, in two, of other nodes, of several
    *("metrics_node", "/metrics_node", "ns/metrics_node", "/ns/metrics_node", "/a/b/metrics_node"),
    *("/other/metrics_node", "metrics_nodes", "/**", "/*", "**", "*", "/**/metrics_node"),
    *("/*/metrics_node", "/*/*", "/ns/*", "/ns/**", "/a/*/metrics_node", "/*/*/*", "/a/**/b/*"),
)


@pytest.mark.parametrize("namespace", ["", "ns", "a/b"])
@pytest.mark.usefixtures("ros_domain")
def test_sections_of_a_file_count_without_ros_as_they_do_with_it(namespace: str, tmp_path: Path) -> None:
    file, wrong = tmp_path / "params.yaml", list[str]()
    for section in SECTIONS:
        file.write_text(f"'{section}': {{ros__parameters: {{gravity: 9.0}}}}")
        context = Context()
        rclpy.init(args=["--ros-args", "--params-file", str(file)], context=context)
        node = Node("metrics_node", namespace=namespace, context=context)
        of_ros = node.declare_parameter("gravity", 0.0).value == 9.0
        node.destroy_node()
        rclpy.shutdown(context=context)
        try:
            of_file = bool(read_values(file, namespace))
        except ParameterError:
            of_file = False
        wrong += [section] if of_ros != of_file else []
    assert wrong == []
