"""When a row is due, live and recorded."""
