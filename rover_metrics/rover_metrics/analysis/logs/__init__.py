"""Logs read from CSV files."""
