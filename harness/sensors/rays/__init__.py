"""Compiled ray casting against heightfield and obstacles."""
