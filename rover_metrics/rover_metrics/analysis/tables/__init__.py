"""The tables of a result: what stands in them, on a terminal, for LaTeX, as CSV."""
