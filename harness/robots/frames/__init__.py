"""Where the parts of a rover are: its frames, and its URDF. No ROS.

A rover's frames come from its compiled model and rover.yaml. What moves (joints, and the rover in the
frame odom) becomes a sample of each tick (harness.sensors.transforms), what is fixed a Description;
harness.ros.frames sends both.
"""
