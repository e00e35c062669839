"""What every backend does: work on items, whatever the order, and tell when a worker was lost."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Sequence
from typing import Self, TypeVar

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")


class WorkerLost(Exception):
    """A worker died; what it was doing has to be done again."""


class Backend(ABC):
    """Workers; a context that lets go of them."""

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
