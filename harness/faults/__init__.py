"""Sensor faults: one frozen class each, parsed once, applied to any sensor."""
