"""Launches metrics_node: ros2 launch rover_metrics metrics.launch.py use_sim_time:=true.

An argument that is given wins over the parameter file; one that is not given leaves the file alone.
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = "rover_metrics"
NOT_GIVEN = ""
DEFAULT_PARAMS_FILE = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "metrics.yaml"])
PARAMETERS = {
    "use_sim_time": (bool, "follow /clock, as with every simulator"),
    "log_dir": (str, "folder for the CSV"),
    "debug_mode": (bool, "report clearance, collisions and distance while running"),
    "extended_columns": (bool, "log the extended columns after the twelve"),
    "debug_interval": (int, "callbacks of a topic from one debug report to the next"),
}


def generate_launch_description() -> LaunchDescription:
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value=NOT_GIVEN, description=description)
                for name, (_, description) in PARAMETERS.items()
            ),
            DeclareLaunchArgument(
                "params_file", default_value=DEFAULT_PARAMS_FILE, description="YAML of parameters"
            ),
            DeclareLaunchArgument(
                "namespace", default_value=NOT_GIVEN, description="of the node and its topics"
            ),
            OpaqueFunction(function=_metrics_node),
        ]
    )


def _metrics_node(context: LaunchContext) -> list[Node]:
    given = {
        name: ParameterValue(LaunchConfiguration(name), value_type=kind)
        for name, (kind, _) in PARAMETERS.items()
        if LaunchConfiguration(name).perform(context) != NOT_GIVEN
    }
    return [
        Node(
            package=PACKAGE,
            executable="metrics_node",
            namespace=LaunchConfiguration("namespace"),
            parameters=[LaunchConfiguration("params_file"), *([given] if given else [])],
            output="screen",
        )
    ]
