"""The parameters of metrics_node from a ROS parameter file, without ROS."""

import json
from pathlib import Path

import pytest

from rover_metrics.core.thresholds import Thresholds
from rover_metrics.errors import ParameterError
from rover_metrics.extended.parameter_file import read_values
from rover_metrics.extended.settings import ExtendedSettings, Settings
from tests.rover_metrics.conftest import VALUES


def read_parameters(path: Path) -> Settings:
    return Settings().updated(read_values(path))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "params.yaml"


def section(*lines: str, name: str = "metrics_node") -> str:
    return f'"{name}":\n  ros__parameters:\n' + "".join(f"    {line}\n" for line in lines)


def doubled(times: int) -> str:
    """A short text of lists whose aliases stand for twice as much each time."""
    return "a0: &a0 [x]\n" + "".join(f"a{n}: &a{n} [*a{n - 1}, *a{n - 1}]\n" for n in range(1, times))


def test_every_parameter_is_read_as_it_stands_there(file: Path) -> None:
    lines = (f"{name}: {json.dumps(value)}" for name, value in VALUES.items())
    file.write_text(section("use_sim_time: true", *lines))
    assert read_values(file) == VALUES


@pytest.mark.parametrize(("depth", "values"), [(62, 5), (1, 490)])
def test_the_bounds_of_a_file_are_met_by_one_value_more(
    file: Path, depth: int, values: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def text(depth: int, values: int) -> str:
        lists, aliases = "[" * depth + "x" + "]" * depth, "*a, " * values + "y, " * values
        return f"{section('fsync: true')}other: {lists}\na: &a y\nb: [{aliases}]\n"

    monkeypatch.setattr("rover_metrics.log.documents.MOST_VALUES", 1000)
    file.write_text(text(depth, values))
    assert read_values(file) == {"fsync": True}
    file.write_text(text(depth + 2, values + 10))
    with pytest.raises(ParameterError, match=r"more than 64 deep|more than 1,000 values"):
        read_values(file)


def test_what_is_not_named_keeps_its_default(file: Path) -> None:
    file.write_text(section("use_sim_time: true", "qos_overrides./scan.x: best_effort", "footprint: []"))
    assert read_parameters(file) == Settings(
        thresholds=Thresholds(), extended_columns=False, extended=ExtendedSettings()
    )


@pytest.mark.parametrize("name", ["metrics_node", "/metrics_node", "*", "/**", "**", "/**/metrics_node"])
def test_sections_of_the_node_count_and_the_later_one_wins(file: Path, name: str) -> None:
    other = section("collision_threshold: 9.0", name="metrics_nodes")
    first = section("collision_threshold: 8.0", "distance_threshold: 0.1", name="/*")
    file.write_text(other + first + section("collision_threshold: 0.4", name=name))
    assert read_parameters(file).thresholds == Thresholds(
        collision_threshold=0.4, distance_threshold=0.1
    )
    everybodys = section("robot_radius: 0.3", "gravity: 9.8", name="/**")
    file.write_text(f"{everybodys}ns:\n  metrics_node:\n    ros__parameters:\n      fsync: true\n")
    assert read_values(file) == {"gravity": 9.8}
    assert read_values(file, "ns") == read_values(file, None) == {"gravity": 9.8, "fsync": True}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (section("collision_threshold: 1"), "(1.0, not 1) from 0.0 to 100"),
        (section("collision_threshold: true"), "collision_threshold must be a number"),
        (section("collision_threshold: -1.0"), "must be from 0.0 to 100.0 m"),
        (section("threshold: 1.0"), "there is no parameter threshold; did you mean"),
        (section("colision_threshold: 1.0", name="/**"), "did you mean collision_threshold?"),
        (section("debug_interval: true"), "debug_interval must be an integer"),
        (section("fsync: 1"), "fsync must be true or false"),
        (section("log_dir: 7"), "parameter log_dir must be the path of a folder, as text"),
        (section("lidar_pose: [1.0, 2, 3.0]"), "lidar_pose must be a list of three numbers"),
        (section("x: 1", name="other"), "no section '/metrics_node"),
        ("metrics_node: {ros__parameters: 3}", "no section '/metrics_node"),
        ("metrics_node: [1.0, x]", "no section '/metrics_node"),
        ("metrics_node: [", "cannot read parameters"),
        ("", "no section '/metrics_node"),
        (doubled(25), "more than 100,000 values; give fewer, or no alias"),
        (section("? {a: 1}\n    : 1"), "found unhashable key"),
        (section("fsync: !!bool x"), "not valid YAML: 'x'"),
        (section("log_dir: 2001-99-99"), "month must be in 1..12"),
        (section("footprint: [1.0, 2.0]"), "footprint has 1 corners, not 3 to 100"),
        (section("footprint: [1, 2, 3]"), "footprint must be a list of numbers with decimal points"),
    ],
)
def test_a_bad_file_is_one_line(file: Path, text: str, told: str) -> None:
    file.write_text(text)
    with pytest.raises(ParameterError) as refused:
        read_values(file)
    assert told in str(refused.value)
    assert str(file) in str(refused.value)
    assert "\n" not in str(refused.value)
    file.unlink()
    with pytest.raises(ParameterError) as refused:
        read_values(file)
    assert str(refused.value) == f"cannot read parameters from {file}: No such file or directory"


def test_a_value_that_is_0_false_or_empty_is_a_value(file: Path) -> None:
    file.write_text(section("publish_metrics: false", "stale_after: 0.0", "footprint: []"))
    assert read_values(file) == {"publish_metrics": False, "stale_after": 0.0}
    file.write_text(section("log_dir: ''"))
    with pytest.raises(ParameterError, match="not empty text"):
        read_values(file)
