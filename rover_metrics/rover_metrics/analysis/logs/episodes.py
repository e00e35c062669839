"""Where episodes begin in a log that several episodes were written to, one after another."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from rover_metrics.analysis.logs.log import Floats, Integers

DEFAULT_GAP = 10.0  # s: ten times the logging period; hand-edited logs lack a row or two at most


def episode_starts(
    stamps: Floats, counters: Iterable[NDArray[np.floating]], gap: float = DEFAULT_GAP
) -> Integers:
    """Find the first row of each episode.

    An episode begins where the time goes back (the simulation was reset), where it leaps by more
    than a gap, or where a counter falls (the node was restarted).

    Args:
        stamps: Time of each row [s], at least one row.
        counters: Columns that only grow within an episode; NaN is skipped.
        gap: Longest time between two rows of one episode [s].

    Returns:
        Row numbers, ascending; the first is 0.
    """
    steps = np.diff(stamps)
    begins = np.concatenate(([True], (steps < 0) | (steps > gap)))
    for counter in counters:
        known = np.flatnonzero(np.isfinite(counter))
        begins[known[1:][np.diff(counter[known]) < 0]] = True
    return np.flatnonzero(begins)
