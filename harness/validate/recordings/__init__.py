"""Recordings of real rovers: CSV files and bags -> series of commands, wheels, IMU and poses."""
