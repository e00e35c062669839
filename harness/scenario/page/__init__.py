"""The page of a suite: what failed, and scenarios cell by cell."""
