"""Work on many items, in any order; what a lost worker has not done is done again."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from functools import partial
from typing import Self, TypeVar

from harness.base.errors import PluginFailed, RunFailed
from rover_metrics.errors import KnownError
from rover_metrics.plugins import blamed

Key = TypeVar("Key")
Item = TypeVar("Item")
Outcome = TypeVar("Outcome")
Show = Callable[[int, int], None]  # called with how many are done, and of how many

TRIES = 3  # in a row in which workers die before a single outcome has come
NAMED = 3  # items that a message names


class WorkerLost(Exception):
    """A worker died; what it was doing has to be done again."""


class Workers(ABC):
    """Workers in other processes; a context that lets go of them."""

    @abstractmethod
    def map(
        self, work: Callable[[Item], Outcome], items: Sequence[Item]
    ) -> Generator[Outcome, None, None]:
        """Yields the outcomes of all items, each once, as soon as they are there.

        Closing the generator gives up what is not done.

        Raises:
            WorkerLost: A worker died; items whose outcome has not come may be given again.
        """

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:  # noqa: B027 - processes of this machine live no longer than `map`
        """Lets go of the workers."""


def work_off(
    items: Mapping[Key, Item],
    work: Callable[[Item], Outcome],
    workers: Workers,
    keep: Callable[[Key, Outcome], None],
    *,
    name: Callable[[Key], str],
    mend: str,
) -> None:
    """Has all items worked on; what a worker that dies has not done is given again.

    Args:
        items: By what they are known by.
        work: Makes an outcome of an item, in a worker.
        workers: Who works.
        keep: Takes each outcome as soon as it is there.
        name: Of an item, in messages.
        mend: What a user can do when all workers are lost.

    Raises:
        RunFailed: Workers died again and again.
    """
    left, fruitless = dict(items), 0
    while left:
        before = len(left)
        try:
            with closing(workers.map(partial(_keyed, work), list(left.items()))) as outcomes:
                for key, outcome in outcomes:
                    keep(key, outcome)
                    del left[key]
        except WorkerLost as error:
            fruitless = fruitless + 1 if len(left) == before else 0
            if fruitless == TRIES:
                names = [*map(name, left)]
                more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
                undone = ", ".join(names[:NAMED]) + more
                raise RunFailed(f"{error}; not done: {undone}; {mend}") from error


def _keyed(work: Callable[[Item], Outcome], item: tuple[Key, Item]) -> tuple[Key, Outcome]:
    """The outcome of an item with its key.

    What a plug-in raises is told here: errors get to whoever gave the work without their lines of code.
    """
    try:
        return item[0], work(item[1])
    except KnownError:
        raise
    except (Exception, SystemExit) as error:
        if reason := blamed(error):
            raise PluginFailed(f"a plug-in failed: {reason}") from error
        raise
