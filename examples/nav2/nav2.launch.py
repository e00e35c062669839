"""Starts Nav2 for a rover, without a map: ros2 launch examples/nav2/nav2.launch.py robot:=leo.

It starts the nodes itself instead of nav2_bringup's navigation_launch.py: from Jazzy on that one starts
more of them (docking, routes), which want parameters for what no rover here has.
"""

import os
from pathlib import Path

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

HERE = Path(__file__).resolve().parent
ROVERS = ("leo", "rover_zero4wd")
RAW = ("cmd_vel", "cmd_vel_nav")  # commands on their way to the smoother
NODES = {  # name, which is the executable's too -> package and remapped topics
    "controller_server": ("nav2_controller", [RAW]),
    "planner_server": ("nav2_planner", []),
    "smoother_server": ("nav2_smoother", []),
    "behavior_server": ("nav2_behaviors", [RAW]),
    "bt_navigator": ("nav2_bt_navigator", []),
    "waypoint_follower": ("nav2_waypoint_follower", []),
    "velocity_smoother": ("nav2_velocity_smoother", [RAW, ("cmd_vel_smoothed", "cmd_vel")]),
}


def generate_launch_description() -> LaunchDescription:
    """Returns the launch argument and the nodes."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("robot", default_value="leo", description=" or ".join(ROVERS)),
            OpaqueFunction(function=_nodes),
        ]
    )


def _nodes(context: LaunchContext) -> list[Node]:
    robot: str = LaunchConfiguration("robot").perform(context)
    if robot not in ROVERS:
        message = f"no parameters for robot:={robot}; give one of {', '.join(ROVERS)}"
        raise RuntimeError(message)
    files = ["nav2.yaml", f"{robot}.yaml"]
    if os.environ.get("ROS_DISTRO") == "humble":
        files.append("humble.yaml")
    parameters = [str(HERE / file) for file in files]
    nodes = [
        Node(
            package=package,
            executable=name,
            name=name,
            output="screen",
            parameters=parameters,
            remappings=remappings,
        )
        for name, (package, remappings) in NODES.items()
    ]
    manager = Node(
        package="nav2_lifecycle_manager",
        executable="lifecycle_manager",
        name="lifecycle_manager_navigation",
        output="screen",
        parameters=[{"use_sim_time": True, "autostart": True, "node_names": list(NODES)}],
    )
    return [*nodes, manager]
