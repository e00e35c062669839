"""What every backend does: work on items, whatever the order, and tell when a worker was lost."""

import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterator, Sequence
from types import TracebackType
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
        """The outcomes of all items, each once, as soon as they are there.

        Closing the generator gives up what is not done.

        Raises:
            WorkerLost: A worker died; items whose outcome has not come may be given again.
        """

    def close(self) -> None:  # noqa: B027 - processes of this machine need nothing
        """Lets go of the workers."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def closed_quietly(outcomes: Generator[Outcome, None, None]) -> Iterator[Outcome]:
    """Passes joblib's outcomes on, and ends joblib without a word where nobody wants the rest."""
    try:
        # No `yield from`: it would close joblib's generator before its warning is off.
        for outcome in outcomes:  # noqa: UP028 - see above
            yield outcome
    finally:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # that work is thrown away
            outcomes.close()
