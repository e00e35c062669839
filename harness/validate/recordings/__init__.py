"""Recordings of rovers: CSV files -> series of commands, wheels, IMU and poses."""
