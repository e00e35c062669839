"""Pages that need no network: what all of them share, and that of a run (run/)."""
