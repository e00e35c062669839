"""Heightmap files: reading, regridding, the terrain made of them."""
