"""Which topics the node listens to, relative to its namespace."""

from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import PoseArray
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Bool, Float64MultiArray

from rover_metrics.health.reception import Reception
from rover_metrics.ros.parameters import BEST_EFFORT
from rover_metrics.ros.sensor_callbacks import SensorCallbacks
from rover_metrics.ros.subscriptions import subscribe


def subscribe_to_sensors(node: Node, sensors: SensorCallbacks, heard: Reception) -> None:
    """Subscribe to the four sensor topics.

    Raises:
        ParameterError: The launch gave a reliability that does not exist.
    """
    sensors.scan = subscribe(node, LaserScan, "scan", sensors.lidar_callback, heard)
    sensors.imu = subscribe(node, Imu, "imu/data", sensors.imu_callback, heard)
    # Only the newest pose matters; reliable delivery would queue old ones.
    sensors.pose = subscribe(
        node,
        PoseArray,
        "rover/pose_array",
        sensors.pose_array_callback,
        heard,
        reliability=BEST_EFFORT,
        depth=1,
    )
    sensors.odometry = subscribe(node, Odometry, "odometry/wheels", sensors.odometry_callback, heard)


def subscribe_to_truth(node: Node, sensors: SensorCallbacks, heard: Reception) -> None:
    """Subscribe to what only simulators publish.

    Raises:
        ParameterError: The launch gave a reliability that does not exist.
    """

    def truth(kind: type, name: str, callback: Callable[[Any], None]) -> str:
        return subscribe(node, kind, name, callback, heard, may_be_missing=True)

    sensors.ground_truth = truth(Odometry, "odom_ground_truth", sensors.ground_truth_callback)
    sensors.contact = truth(Bool, "rover/truth/contact", sensors.contact_callback)
    sensors.traversal = truth(Float64MultiArray, "rover/truth/traversal", sensors.traversal_callback)
