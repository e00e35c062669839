"""The launch files, as far as they can be checked without ros2 launch, and config/.

Stand-ins for launch and launch_ros take only the keywords that the real ones take (Humble to Kilted).
"""

import runpy
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import field, make_dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from rover_metrics.extended.parameter_file import read_values
from rover_metrics.extended.settings import Settings

Patch = pytest.MonkeyPatch

PACKAGE = Path(__file__).parents[2] / "rover_metrics"
METRICS = PACKAGE / "launch/metrics.launch.py"
HARNESS = PACKAGE / "launch/harness.launch.py"
CONFIG = PACKAGE / "config/metrics.yaml"
ROS2 = shutil.which("ros2")


class LaunchDescription(list[Any]):
    """A list of actions."""


def stand_in(name: str, *fields: str, **defaults: object) -> Any:  # noqa: ANN401 - a class
    """A class that takes these values, the last of them by default."""
    optional = [(each, object, field(default=value)) for each, value in defaults.items()]
    return make_dataclass(name, [*fields, *optional])


LaunchContext = stand_in("LaunchContext", "launch_configurations")
DeclareLaunchArgument = stand_in("DeclareLaunchArgument", "name", default_value=None, description="")
OpaqueFunction = stand_in("OpaqueFunction", "function")
ExecuteProcess = stand_in("ExecuteProcess", "cmd", output="log", on_exit=())
Shutdown = stand_in("Shutdown", "reason")
FindPackageShare = stand_in("FindPackageShare", "package")
PathJoinSubstitution = stand_in("PathJoinSubstitution", "parts")
ParameterValue = stand_in("ParameterValue", "value", "value_type")
Node = stand_in("Node", "package", "executable", "namespace", "parameters", output="log")
LaunchConfiguration = stand_in("LaunchConfiguration", "name")
LaunchConfiguration.perform = lambda self, context: context.launch_configurations[self.name]


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
def _stand_ins(monkeypatch: Patch) -> None:
    for name, members in STAND_INS.items():
        module = ModuleType(name)
        for member in members:
            setattr(module, member.__name__, member)
        monkeypatch.setitem(sys.modules, name, module)


def described(file: Path) -> LaunchDescription:
    description = runpy.run_path(str(file))["generate_launch_description"]()
    assert isinstance(description, LaunchDescription)
    return description


def arguments(file: Path) -> dict[str, Any]:
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


def test_metrics_launches_the_installed_program_with_a_parameter_file_of_the_defaults() -> None:
    node = launched(METRICS, {})
    assert (node.package, node.output) == ("rover_metrics", "screen")
    assert f'"{node.executable} = rover_metrics.__main__:main"' in (PACKAGE / "setup.py").read_text()
    assert node.namespace == LaunchConfiguration("namespace")
    assert node.parameters == [LaunchConfiguration("params_file")]
    default = arguments(METRICS)["params_file"].default_value
    assert default == PathJoinSubstitution([FindPackageShare("rover_metrics"), "config", CONFIG.name])
    values = read_values(CONFIG)
    assert values == {name: Settings().parameters[name] for name in values}
    assert "/**:\n" in CONFIG.read_text()


def test_an_argument_that_is_given_comes_after_the_parameter_file_and_has_its_type() -> None:
    given = {"use_sim_time": "true", "log_dir": "2025", "debug_mode": "true", "debug_interval": "5"}
    file, values = launched(METRICS, given).parameters
    assert file == LaunchConfiguration("params_file")
    types = {"use_sim_time": bool, "log_dir": str, "debug_mode": bool, "debug_interval": int}
    assert values == {n: ParameterValue(LaunchConfiguration(n), kind) for n, kind in types.items()}


def test_harness_passes_on_every_option_as_the_program_knows_it(monkeypatch: Patch) -> None:
    command_line = pytest.importorskip("harness.cli.options", reason="needs the harness")
    monkeypatch.setenv("VIRTUAL_ENV", "/venv")
    process = launched(HARNESS, {})
    assert process.cmd == ["/venv/bin/python", "-m", "harness.run"]
    assert process.on_exit == [Shutdown("the run has ended")]
    options = {"terrain": "maze", "robot": "rover_zero4wd", "driver": "spin", "seed": "3"}
    options |= {"duration": "7.5", "rate": "max", "log_dir": "-logs", "extended": "true"}
    parsed = command_line.parse_run(launched(HARNESS, options).cmd[3:])
    (rover,) = parsed.run.rovers
    assert (parsed.run.world.terrain, rover.robot, rover.driver) == ("maze", "rover_zero4wd", "spin")
    assert (parsed.run.seed, parsed.run.duration, parsed.ros.rate) == (3, 7.5, None)
    assert parsed.ros.log_dir == Path("-logs")  # which is no option
    assert parsed.settings[0].extended_columns


@pytest.mark.parametrize("namespace", ["rover1", "/rover1", "/rover1/"])
def test_harness_takes_a_namespace_with_or_without_slashes(namespace: str) -> None:
    command = launched(HARNESS, {"namespace": namespace, "params_file": "p.yaml"}).cmd
    assert command[3:] == ["--ros-args", "--params-file", "p.yaml", "-r", "__ns:=/rover1"]


@pytest.mark.skipif(ROS2 is None, reason="needs ros2 launch, which PyPI does not have")
@pytest.mark.parametrize("file", [METRICS, HARNESS], ids=lambda file: file.name)
def test_ros2_launch_itself_takes_the_file(file: Path) -> None:
    assert ROS2 is not None
    run = subprocess.run(
        [ROS2, "launch", str(file), "--show-args"], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert "'namespace'" in run.stdout
