"""A recording of a rover -> the numbers of its rover.yaml: `harness.fit`."""
