"""Traversal metrics of an off-road rover: sensor samples in, one CSV row a second out."""
