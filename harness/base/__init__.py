"""What every station stands on: errors, simulation time, files, signals."""
