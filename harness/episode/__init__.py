"""Episode: a seeded drive as a stream of batches, the loop over it, and what a run comes to."""
