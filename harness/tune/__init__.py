"""Threshold tuning: episodes without ROS, scored against the truth, chosen and checked apart."""
