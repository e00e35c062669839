"""Worlds that Gazebo's SDF files describe: reading them, down to solids in one frame."""
