"""Logs of social navigation: what they hold, what a run comes to, whether two groups of runs differ."""
