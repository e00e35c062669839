"""Scores of thresholds and the choice between them."""
