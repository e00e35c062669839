"""Drawings of the rover on the tuning page."""
