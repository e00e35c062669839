"""Terrains, obstacles, and how they become one MuJoCo model with a rover."""
