"""The launch files, as far as they can be checked without ros2 launch, and config/.

Stand-ins for launch and launch_ros take only the keywords that the real ones take (Humble to Kilted).
"""

import runpy
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

PACKAGE = Path(__file__).parents[2] / "rover_metrics"
METRICS = PACKAGE / "launch/metrics.launch.py"
HARNESS = PACKAGE / "launch/harness.launch.py"
CONFIG = PACKAGE / "config/metrics.yaml"
ROS2 = shutil.which("ros2")


class LaunchDescription(list[Any]):
    """A list of actions."""


@dataclass
class LaunchContext:
    launch_configurations: dict[str, str]


@dataclass
class DeclareLaunchArgument:
    name: str
    default_value: object = None
    description: str = ""


@dataclass
class LaunchConfiguration:
    name: str

    def perform(self, context: LaunchContext) -> str:
        return context.launch_configurations[self.name]


@dataclass
class OpaqueFunction:
    function: Any


@dataclass
class ExecuteProcess:
    cmd: list[str]
    output: str = "log"
    on_exit: list[object] = field(default_factory=list)


@dataclass
class Shutdown:
    reason: str


@dataclass
class FindPackageShare:
    package: str


@dataclass
class PathJoinSubstitution:
    parts: list[object]


@dataclass
class ParameterValue:
    value: LaunchConfiguration
    value_type: type


@dataclass
class Node:
    package: str
    executable: str
    namespace: LaunchConfiguration
    parameters: list[Any]
    output: str = "log"


STAND_INS = {
    "launch": (LaunchDescription, LaunchContext),
    "launch.actions": (DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, Shutdown),
    "launch.substitutions": (LaunchConfiguration, PathJoinSubstitution),
    "launch_ros": (),
    "launch_ros.actions": (Node,),
    "launch_ros.parameter_descriptions": (ParameterValue,),
    "launch_ros.substitutions": (FindPackageShare,),
}


@pytest.fixture(autouse=True)
def _stand_ins(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, members in STAND_INS.items():
        module = ModuleType(name)
        for member in members:
            setattr(module, member.__name__, member)
        monkeypatch.setitem(sys.modules, name, module)


def described(file: Path) -> LaunchDescription:
    description = runpy.run_path(str(file))["generate_launch_description"]()
    assert isinstance(description, LaunchDescription)
    return description


def arguments(file: Path) -> dict[str, DeclareLaunchArgument]:
    return {a.name: a for a in described(file) if isinstance(a, DeclareLaunchArgument)}


def launched(file: Path, given: Mapping[str, str]) -> Any:  # noqa: ANN401 - a Node or an ExecuteProcess
    """The one action that the file comes to with some arguments given."""
    assert set(given) <= set(arguments(file))
    values = {name: str(argument.default_value) for name, argument in arguments(file).items()}
    (function,) = [action.function for action in described(file) if isinstance(action, OpaqueFunction)]
    (action,) = function(LaunchContext({**values, **given}))
    return action


@pytest.mark.parametrize("file", [METRICS, HARNESS], ids=lambda file: file.name)
def test_every_argument_is_described_and_may_be_left_out(file: Path) -> None:
    for argument in arguments(file).values():
        assert argument.description, argument.name
        assert argument.default_value is not None, argument.name


def test_metrics_launches_the_installed_program() -> None:
    node = launched(METRICS, {})
    assert (node.package, node.output) == ("rover_metrics", "screen")
    assert f'"{node.executable} = rover_metrics.__main__:main"' in (PACKAGE / "setup.py").read_text()
    assert node.namespace == LaunchConfiguration("namespace")


def test_an_argument_that_is_not_given_leaves_the_parameter_file_alone() -> None:
    assert launched(METRICS, {}).parameters == [LaunchConfiguration("params_file")]


def test_an_argument_that_is_given_comes_after_the_parameter_file_and_has_its_type() -> None:
    given = {"use_sim_time": "true", "log_dir": "2025", "debug_mode": "true", "debug_interval": "5"}
    file, values = launched(METRICS, given).parameters
    assert file == LaunchConfiguration("params_file")
    types = {"use_sim_time": bool, "log_dir": str, "debug_mode": bool, "debug_interval": int}
    assert values == {n: ParameterValue(LaunchConfiguration(n), kind) for n, kind in types.items()}


def test_the_default_parameter_file_exists_and_is_installed() -> None:
    default = arguments(METRICS)["params_file"].default_value
    assert default == PathJoinSubstitution([FindPackageShare("rover_metrics"), "config", CONFIG.name])
    assert CONFIG.is_file()


def test_the_parameter_file_holds_the_defaults_in_every_namespace(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name in STAND_INS:
        monkeypatch.delitem(sys.modules, name)
    rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")
    from rclpy.parameter import parameter_dict_from_yaml_file  # noqa: PLC0415

    from rover_metrics.extended.settings import Settings  # noqa: PLC0415

    assert rclpy
    values = parameter_dict_from_yaml_file(str(CONFIG), use_wildcard=True)
    told = {name: message.value for name, message in values.items()}
    defaults = Settings()
    assert told
    for name, value in told.items():
        has = getattr(defaults, name, None)
        for part in (defaults.thresholds, defaults.extended):
            has = getattr(part, name, None) if has is None else has
        assert plain(value) == has, name


def plain(value: Any) -> bool | int | float:  # noqa: ANN401 - a ParameterValue message
    """The Python value of a parameter message."""
    from rclpy.parameter import parameter_value_to_python  # noqa: PLC0415

    converted: bool | int | float = parameter_value_to_python(value)
    return converted


def test_harness_leaves_what_is_not_given_to_the_program() -> None:
    process = launched(HARNESS, {"python": "/venv/bin/python"})
    assert process.cmd == ["/venv/bin/python", "-m", "harness.run"]
    assert process.on_exit == [Shutdown("the run has ended")]


def test_harness_passes_on_every_option_as_the_program_knows_it(tmp_path: Path) -> None:
    run_parser = pytest.importorskip(
        "harness.cli.run_parser", reason="needs the harness", exc_type=ImportError
    )
    options = {
        "terrain": "maze",
        "robot": "rover_zero4wd",
        "driver": "spin",
        "seed": "-3",
        "duration": "7.5",
        "rate": "max",
        "log_dir": str(tmp_path),
    }
    command = launched(HARNESS, options | {"extended": "true"}).cmd
    parsed = run_parser.run_parser().parse_args(command[3:])
    assert (parsed.terrain, parsed.robot, parsed.driver) == ("maze", "rover_zero4wd", "spin")
    assert (parsed.seed, parsed.duration, parsed.rate) == (-3, 7.5, None)
    assert parsed.log_dir == tmp_path
    assert parsed.extended


@pytest.mark.parametrize("namespace", ["rover1", "/rover1", "/rover1/"])
def test_harness_takes_a_namespace_with_or_without_slashes(namespace: str) -> None:
    command = launched(HARNESS, {"namespace": namespace, "params_file": "p.yaml"}).cmd
    assert command[3:] == ["--ros-args", "--params-file", "p.yaml", "-r", "__ns:=/rover1"]


def test_harness_runs_in_the_active_virtual_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VIRTUAL_ENV", "/venv")
    assert arguments(HARNESS)["python"].default_value == "/venv/bin/python"
    monkeypatch.delenv("VIRTUAL_ENV")
    assert arguments(HARNESS)["python"].default_value == sys.executable


@pytest.mark.skipif(ROS2 is None, reason="needs ros2 launch, which PyPI does not have")
@pytest.mark.parametrize("file", [METRICS, HARNESS], ids=lambda file: file.name)
def test_ros2_launch_itself_takes_the_file(file: Path) -> None:
    assert ROS2 is not None
    run = subprocess.run(
        [ROS2, "launch", str(file), "--show-args"], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert "'namespace'" in run.stdout
