"""The simulator's side: worlds, rovers, sensors, episodes and their bridge to ROS 2."""

__version__ = "0.1.0"
