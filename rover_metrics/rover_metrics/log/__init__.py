"""The CSV log and the record beside it."""
