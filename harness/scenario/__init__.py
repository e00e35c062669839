"""Scenarios: a run with expectations in one file, and one verdict (docs/scenarios.md)."""
