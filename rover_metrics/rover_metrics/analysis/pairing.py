"""Which logs of two groups belong together: those of one seed drove the same world."""

from collections.abc import Sequence
from typing import Literal, get_args

from rover_metrics.analysis.logs.log import Log
from rover_metrics.errors import RoverMetricsError

PairBy = Literal["seed", "order", "none"]
PAIRINGS: tuple[PairBy, ...] = get_args(PairBy)

Pairs = tuple[tuple[int, int], ...]  # places in the first group and in the second

_DESIGN = ("robot", "terrain", "difficulty", "seed")  # arguments of a run, kept in its log's record


def pair(first: Sequence[Log], second: Sequence[Log], by: PairBy) -> Pairs:
    """Returns the pairs of two groups' logs; none unless every log has exactly one partner.

    By seed, whatever else varies within a group must be equal too; what only differs between the
    groups is what they are compared for.

    Args:
        first: Logs of one group.
        second: Logs of the other.
        by: What makes two logs a pair; "none" makes none.

    Returns:
        Places in `first` and in `second`.

    Raises:
        RoverMetricsError: The groups are to be paired by order and differ in length.
    """
    if by == "none":
        return ()
    if by == "order":
        if len(first) != len(second):
            sizes = f"{len(first)} and {len(second)} logs"
            raise RoverMetricsError(f"--pair-by order needs groups of equal size, not {sizes}")
        return tuple((i, i) for i in range(len(first)))
    if not all("seed" in log.arguments for log in (*first, *second)):
        return ()
    varying = [
        name for name in _DESIGN if name == "seed" or _varies(first, name) or _varies(second, name)
    ]
    keys, partners = (
        [tuple(str(log.arguments.get(name)) for name in varying) for log in group]
        for group in (first, second)
    )
    if len(set(keys)) < len(keys) or sorted(keys) != sorted(partners):
        return ()
    return tuple((i, partners.index(key)) for i, key in enumerate(keys))


def _varies(logs: Sequence[Log], argument: str) -> bool:
    return len({str(log.arguments.get(argument)) for log in logs}) > 1
