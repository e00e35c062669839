"""What looks at the simulation and what corrupts its readings."""
