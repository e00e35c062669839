"""The report of a tuning: one page with its curves, intervals and verdicts, and drawings of rovers."""
