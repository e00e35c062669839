"""YAML and JSON that anybody may have written: read here alone, within the bounds of docs/limits.md."""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rover_metrics.errors import RoverMetricsError, reason_of

LARGEST_YAML, LARGEST_JSON = 2**20, 2**26  # [bytes]
DEEPEST = 64  # lists and keys within one another
MOST_VALUES = 100_000  # of YAML, each alias counted as all that it stands for
MOST_DIGITS = 100
_UNDERSCORED = re.compile(r"[-+]?[\d.]*\d_[\d_.eE+-]*")  # which YAML of old takes for a number
_TOO_LONG = re.compile(rf"\d[\d_]{{{MOST_DIGITS}}}|0[xX][\da-fA-F_]{{{MOST_DIGITS}}}")
_TOO_DEEP = f"nested more than {DEEPEST} deep; nest less"


class DocumentError(RoverMetricsError):
    """A file that cannot be read, is no such document or beyond a bound; one line without its name.

    Attributes:
        place: Line and column of what is wrong, from 1; None where that is not known.
    """

    def __init__(self, text: str, place: tuple[int, int] | None = None) -> None:
        super().__init__(text)
        self.place = place


def read_json(path: Path, largest: int = LARGEST_JSON) -> Any:  # noqa: ANN401 - whatever a file holds
    """Returns what a JSON file holds; DocumentError if it is none, or has more than `largest` bytes."""
    return parse_json(_text_of(path, largest))


def parse_json(text: str | bytes) -> Any:  # noqa: ANN401
    """Returns what a JSON text holds, or raises a DocumentError."""
    try:
        text = text if isinstance(text, str) else text.decode()
        _check_digits(text)
        content = json.loads(text)
    except RecursionError as error:
        raise DocumentError(_TOO_DEEP) from error
    except ValueError as error:
        raise DocumentError(f"not valid JSON: {error}") from error
    _check(content)
    return content


def read_yaml(path: Path, *, with_places: bool = False) -> Any:  # noqa: ANN401
    """Returns what a YAML file holds; where each value stands too, as ruamel.yaml has it, if asked for.

    Raises:
        DocumentError: It cannot be read, is no YAML, or is beyond a bound.
    """
    from ruamel.yaml import YAML  # noqa: PLC0415 - takes 25 ms, and most imports of this need no file
    from ruamel.yaml.error import MarkedYAMLError, YAMLError  # noqa: PLC0415

    text = _text_of(path, LARGEST_YAML)
    _check_digits(text)
    try:
        reader = YAML(typ="rt", pure=True) if with_places else YAML(typ="safe", pure=True)
        bounds, parsed = _Bounds(), reader.parser.get_event
        reader.parser.get_event = lambda: bounds.counted(parsed())
        content = reader.load(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark
        place = (mark.line + 1, mark.column + 1) if mark else None
        raise DocumentError(f"not valid YAML: {error.problem}", place) from error
    # What a parser raises of numbers, dates, keys and tags that are none.
    except (YAMLError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise DocumentError(f"not valid YAML: {' '.join(str(error).split())}") from error
    except RecursionError as error:
        raise DocumentError(_TOO_DEEP) from error
    _check(content)
    return content


def read_bytes(path: Path, largest: int) -> bytes:
    """Returns the bytes of a file or a shell's pipe; DocumentError if there are more than `largest`."""
    try:
        # Into a pipe of a shell, as <(...) and /dev/stdin are, somebody writes already.
        is_of_a_shell = path.is_fifo() and path.is_relative_to("/dev")
        if path.exists() and not (path.is_file() or path.is_dir() or is_of_a_shell):
            raise DocumentError("this is not a file but a device or a pipe")
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in its name
        raise DocumentError(reason_of(error)) from error
    if len(content) > largest:
        raise DocumentError(f"larger than {largest:,} bytes; is it the right file?")
    return content


def _text_of(path: Path, largest: int) -> str:
    try:
        return read_bytes(path, largest).decode("utf-8-sig")
    except ValueError as error:
        raise DocumentError(f"no text in UTF-8: {error}") from error


def _check_digits(text: str) -> None:
    if _TOO_LONG.search(text):
        raise DocumentError(f"a number of more than {MOST_DIGITS} digits; give fewer")


class _Bounds:
    """Counts values as if every alias were written out, before anything is built of them."""

    def __init__(self) -> None:
        self._behind: dict[str | None, int] = {}  # values of an anchor
        self._unfinished: list[tuple[str | None, int]] = []  # anchor, and values before it
        self._values = 0

    def counted(self, event: Any) -> Any:  # noqa: ANN401 - as ruamel's
        """Returns the next event of a document; DocumentError if that is beyond a bound."""
        kind = type(event).__name__
        if kind == "AliasEvent":
            if event.anchor not in self._behind:
                raise DocumentError(f"*{event.anchor} stands for nothing before it; write it out")
            self._values += self._behind[event.anchor]
        elif kind == "ScalarEvent":
            self._values, self._behind[event.anchor] = self._values + 1, 1
            if event.implicit[0] and _UNDERSCORED.fullmatch(event.value):
                raise DocumentError(f"{event.value[:40]} is no number; leave _ out, or put it in quotes")
        elif kind in ("SequenceStartEvent", "MappingStartEvent"):
            self._unfinished.append((event.anchor, self._values))
            self._values += 1
        elif kind in ("SequenceEndEvent", "MappingEndEvent"):
            anchor, before = self._unfinished.pop()
            self._behind[anchor] = self._values - before
        if self._values > MOST_VALUES:
            raise DocumentError(f"comes to more than {MOST_VALUES:,} values; give fewer, or no alias")
        if len(self._unfinished) > DEEPEST:
            raise DocumentError(_TOO_DEEP)
        return event


def _check(content: object) -> None:
    """Checks depth and keys."""
    left = [(content, 0)]
    while left:
        value, depth = left.pop()
        if depth > DEEPEST:
            raise DocumentError(_TOO_DEEP)
        if isinstance(value, Mapping):
            wrong = [key for key in value if not isinstance(key, str)]
            if wrong:
                raise DocumentError(f"key {str(wrong[0])[:40]} must be text; put it in quotes")
            left += [(item, depth + 1) for item in value.values()]
        elif isinstance(value, list):
            left += [(item, depth + 1) for item in value]
