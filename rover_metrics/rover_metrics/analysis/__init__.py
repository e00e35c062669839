"""Statistics of metrics logs: pure functions, with reading, plotting and printing around them."""
