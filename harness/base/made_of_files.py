"""What is made of files is kept until one of them changes."""

from collections.abc import Callable, Iterable
from functools import lru_cache, wraps
from pathlib import Path
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")
Files = Iterable[Path | str]


def made_of_files(size: int) -> Callable[[Callable[P, tuple[T, Files]]], Callable[P, T]]:
    """Decorates what makes something of files, so that it is made anew only when one of them changes.

    Args:
        size: How many results are kept, by the arguments.

    Returns:
        A decorator of functions that return what they make, and every file that they have read.
    """

    def decorate(make: Callable[P, tuple[T, Files]]) -> Callable[P, T]:
        @lru_cache(maxsize=size)
        def kept(*args: P.args, **kwargs: P.kwargs) -> tuple[T, tuple[Path, ...], list[int]]:
            made, read = make(*args, **kwargs)
            files = tuple(map(Path, read))
            return made, files, [*map(modified_ns, files)]

        @wraps(make)
        def current(*args: P.args, **kwargs: P.kwargs) -> T:
            made, files, written = kept(*args, **kwargs)  # type: ignore[arg-type]  # all are hashable
            if written != [*map(modified_ns, files)]:
                kept.cache_clear()
                made, *_ = kept(*args, **kwargs)  # type: ignore[arg-type]
            return made

        return current

    return decorate


def modified_ns(path: Path) -> int:
    """Returns when a file was last written [ns]; 0 if there is none."""
    return path.stat().st_mtime_ns if path.exists() else 0
