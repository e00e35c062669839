"""Work of which nothing is done twice: outcomes are kept as they come, whatever becomes of workers."""

from collections.abc import Callable, Mapping
from contextlib import closing
from typing import TypeVar

from harness.base.errors import RunFailed
from harness.tune.backend.base import Backend, Item, Outcome, WorkerLost

Key = TypeVar("Key")

TRIES = 3  # in a row in which workers die before a single outcome has come
NAMED = 3  # items that a message names


def work_off(
    items: Mapping[Key, Item],
    work: Callable[[Item], tuple[Key, Outcome]],
    backend: Backend,
    keep: Callable[[Key, Outcome], None],
    *,
    name: Callable[[Key], str],
    mend: str,
) -> None:
    """Has a backend work on all items; what a worker that dies has not done is given again.

    Args:
        items: By what they are known by.
        work: Gives an item's key and outcome, in a worker.
        backend: Who works.
        keep: Takes each outcome as soon as it is there.
        name: Of an item, in messages.
        mend: What a user can do who has lost all workers.

    Raises:
        RunFailed: Workers died again and again.
    """
    left, fruitless = dict(items), 0
    while left:
        before = len(left)
        try:
            with closing(backend.map(work, list(left.values()))) as outcomes:
                for key, outcome in outcomes:
                    keep(key, outcome)
                    del left[key]
        except WorkerLost as error:
            fruitless = fruitless + 1 if len(left) == before else 0
            if fruitless == TRIES:
                names = [name(key) for key in left]
                more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
                undone = ", ".join(names[:NAMED]) + more
                raise RunFailed(f"{error}; not done: {undone}; {mend}") from error
