"""YAML and JSON of strangers: what is too large, too deep or multiplies itself is refused."""

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

from rover_metrics.errors import RoverMetricsError

LARGEST = 2**22  # bytes
DEEPEST = 100  # lists and mappings in each other
MOST_VALUES = 100_000  # those behind an alias as often as it is used

T = TypeVar("T")

# What a parser raises of numbers, dates, keys and tags that are none.
_NONSENSE = (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError)


class DocumentError(RoverMetricsError):
    """A file that cannot be read, or is no such document; one line without the file's name."""


def read_yaml(path: Path) -> Any:  # noqa: ANN401 - whatever a file holds
    """Returns the content of a YAML file as plain values, or raises a DocumentError."""
    from ruamel.yaml import YAML  # noqa: PLC0415 - takes 25 ms, and most imports of this need no file
    from ruamel.yaml.error import YAMLError  # noqa: PLC0415

    def parsed(data: bytes) -> Any:  # noqa: ANN401
        try:
            _require_bounds(YAML(typ="safe", pure=True).parse(data))
            return YAML(typ="safe").load(data)
        except YAMLError as error:
            raise DocumentError(f"no valid YAML: {' '.join(str(error).split())}") from error

    return _read(path, "YAML", parsed)


def read_json(path: Path) -> Any:  # noqa: ANN401
    """Returns the content of a JSON file, or raises a DocumentError."""
    return _read(path, "JSON", json.loads)


def _read(path: Path, name: str, parsed: Callable[[bytes], T]) -> T:
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except OSError as error:
        raise DocumentError(error.strerror or str(error)) from error
    if len(data) > LARGEST:
        raise DocumentError(f"larger than {LARGEST >> 20} MiB; is it the right file?")
    try:
        return parsed(data)
    except RecursionError as error:
        raise DocumentError("values nested too deep; make it flatter") from error
    except _NONSENSE as error:
        reason = " ".join(str(error).split()).partition("; use sys.")[0]  # which is no mend for users
        raise DocumentError(f"no valid {name}: {reason}") from error


def _require_bounds(events: Iterable[Any]) -> None:
    """Counts values as if every alias were written out, before anything is built of them."""
    from ruamel.yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent, ScalarEvent  # noqa: PLC0415

    behind: dict[str | None, int] = {}  # an anchor
    unfinished: list[tuple[str | None, int]] = []  # anchor, and values before it
    values = 0
    for event in events:
        if isinstance(event, CollectionEndEvent):
            anchor, before = unfinished.pop()
            behind[anchor] = values - before
        elif isinstance(event, AliasEvent):
            if event.anchor not in behind:
                raise DocumentError(f"*{event.anchor} stands for what it is part of; write it out")
            values += behind[event.anchor]
        elif isinstance(event, ScalarEvent):
            values, behind[event.anchor] = values + 1, 1
        elif isinstance(event, CollectionStartEvent):
            unfinished.append((event.anchor, values))
            values += 1
        if len(unfinished) > DEEPEST:
            raise DocumentError(f"values nested deeper than {DEEPEST}; make it flatter")
        if values > MOST_VALUES:
            raise DocumentError(f"more than {MOST_VALUES:,} values, its aliases written out")
