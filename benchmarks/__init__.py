"""Benchmarks: what this project costs, as ratios measured side by side in one run. Not tests."""
