"""Launches a simulated rover with its metrics: ros2 launch rover_metrics harness.launch.py.

The harness is not a ROS package: it runs in a Python that has it installed, by default that of the
active virtual environment. It hosts metrics_node itself, in lock-step; when it ends, the launch ends.
"""

import os
import sys

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration

NOT_GIVEN = ""  # leaves it to the default of harness.run
OPTIONS = {
    "terrain": "name, or heightmap file; python -m harness.run --list",
    "robot": "leo or rover_zero4wd, or the folder of a rover",
    "driver": "who steers: a script's name, or cmd_vel for your own node",
    "seed": "of terrain, obstacles, driver and noise",
    "duration": "simulated seconds",
    "rate": "times real time, or max",
    "log_dir": "folder for the CSV",
}
FURTHER = {
    "extended": "true logs the extended columns too",
    "params_file": "YAML of metrics_node's parameters",
    "namespace": "of all topics but /clock",
    "python": "interpreter that has the harness",
}


def generate_launch_description() -> LaunchDescription:
    given = {"extended": "false", "python": _python()}
    arguments = [
        DeclareLaunchArgument(name, default_value=given.get(name, NOT_GIVEN), description=about)
        for name, about in {**OPTIONS, **FURTHER}.items()
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=_harness)])


def _python() -> str:
    environment = os.environ.get("VIRTUAL_ENV")
    return os.path.join(environment, "bin", "python") if environment else sys.executable  # noqa: PTH118


def _harness(context: LaunchContext) -> list[ExecuteProcess]:
    def given(name: str) -> str:
        value: str = LaunchConfiguration(name).perform(context)
        return value

    # --name=value, so that a value that begins with a dash stays a value
    words = [f"--{name.replace('_', '-')}={given(name)}" for name in OPTIONS if given(name)]
    if given("extended").lower() == "true":
        words.append("--extended")
    ros_args = [
        *(["--params-file", given("params_file")] if given("params_file") else []),
        *(["-r", f"__ns:=/{given('namespace').strip('/')}"] if given("namespace").strip("/") else []),
    ]
    command = [
        given("python"),
        "-m",
        "harness.run",
        *words,
        *(["--ros-args", *ros_args] if ros_args else []),
    ]
    return [ExecuteProcess(cmd=command, output="screen", on_exit=[Shutdown(reason="the run has ended")])]
