"""A rover of ours beside recordings of a real one: the same measures of both, with limits."""
