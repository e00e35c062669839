"""Heightmap files: reading them, the terrain made of them."""
