"""Solids, meshes among them, as a ground to drive on and obstacles that stand on it."""
