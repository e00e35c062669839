"""Recordings: the same samples as live topics give."""
