"""YAML and JSON that anybody may have written: read here alone, within the bounds of docs/limits.md."""

import json
import re
from collections.abc import Iterator, Mapping
from io import StringIO
from pathlib import Path
from typing import Any

from harness.base.errors import UsageError

LARGEST_YAML, LARGEST_JSON = 2**20, 2**26  # [bytes]
DEEPEST = 64  # lists and keys within one another
MOST_VALUES = 100_000  # of YAML, each alias counted as all that it stands for
MOST_DIGITS = 100
_TOO_LONG = re.compile(rf"\d[\d_]{{{MOST_DIGITS}}}|0[xX][\da-fA-F_]{{{MOST_DIGITS}}}")


def read_json(path: Path, largest: int = LARGEST_JSON) -> Any:  # noqa: ANN401 - whatever a file holds
    """Returns what a JSON file holds; UsageError if it cannot be read, or is beyond a bound."""
    return parse_json(_text_of(path, largest), str(path))


def parse_json(text: str | bytes, where: str) -> Any:  # noqa: ANN401 - whatever it holds
    """Returns what a JSON text from `where` holds; UsageError if it is none, or beyond a bound."""
    try:
        text = text if isinstance(text, str) else text.decode()
        _check_digits(text, where)
        content = json.loads(text)
    except RecursionError as error:
        raise _too_deep(where) from error
    except ValueError as error:
        raise UsageError(f"{where} is not valid JSON: {error}") from error
    _check(content, where)
    return content


def read_mapping(path: Path) -> dict[str, Any]:
    """Returns the keys and values of a YAML file; UsageError if it has none or is beyond a bound."""
    content = read_yaml(path)
    if not isinstance(content, dict):
        raise UsageError(f"{path} must hold keys with values")
    return content


def read_yaml(path: Path, *, with_places: bool = False) -> Any:  # noqa: ANN401 - whatever a file holds
    """Returns what a YAML file holds; where each value stands too, as ruamel.yaml has it, if asked for.

    Raises:
        UsageError: It cannot be read, is no YAML, or is beyond a bound.
    """
    from ruamel.yaml import YAML  # noqa: PLC0415 - takes 25 ms, and most imports of this need no file
    from ruamel.yaml.error import MarkedYAMLError, YAMLError  # noqa: PLC0415

    text = _text_of(path, LARGEST_YAML)
    _check_digits(text, str(path))
    try:
        _check_aliases(YAML(typ="safe", pure=True).parse(StringIO(text)), str(path))
        content = YAML(typ="rt" if with_places else "safe").load(StringIO(text))
    except MarkedYAMLError as error:
        mark = error.problem_mark
        place = f":{mark.line + 1}:{mark.column + 1}" if mark else ""
        raise UsageError(f"{path}{place}: not valid YAML: {error.problem}") from error
    except (YAMLError, ValueError, TypeError) as error:  # TypeError: a key that is a list
        raise UsageError(f"{path}: not valid YAML: {' '.join(str(error).split())}") from error
    _check(content, str(path))
    return content


def _text_of(path: Path, largest: int) -> str:
    try:
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}") from error
    if len(content) > largest:
        raise UsageError(f"{path} is larger than {largest:,} bytes; name another file")
    try:
        return content.decode("utf-8-sig")
    except ValueError as error:
        raise UsageError(f"{path} is no text in UTF-8: {error}") from error


def _check_digits(text: str, where: str) -> None:
    if _TOO_LONG.search(text):
        raise UsageError(f"{where} holds a number of more than {MOST_DIGITS} digits; give fewer")


def _too_deep(where: str) -> UsageError:
    return UsageError(f"{where} is nested more than {DEEPEST} deep; nest less")


def _check_aliases(events: Iterator[Any], where: str) -> None:
    """Checks what a YAML text comes to before anything is made of it: aliases double again and again."""
    count, sizes, opened = 0, dict[str, int](), list[tuple[str | None, int]]()
    for event in events:
        kind, anchor = type(event).__name__, getattr(event, "anchor", None)
        if kind == "AliasEvent":
            if anchor not in sizes:
                raise UsageError(f"{where}: *{anchor} stands for nothing before it; write it out")
            count += sizes[anchor]
        elif kind in ("SequenceStartEvent", "MappingStartEvent"):
            opened.append((anchor, count))
            count += 1
        elif kind in ("SequenceEndEvent", "MappingEndEvent"):
            name, began = opened.pop()
            sizes[name or ""] = count - began
        elif kind == "ScalarEvent":
            count += 1
            sizes[anchor or ""] = 1
        if count > MOST_VALUES:
            raise UsageError(
                f"{where} comes to more than {MOST_VALUES:,} values; give fewer, or no alias"
            )
        if len(opened) > DEEPEST:
            raise _too_deep(where)


def _check(content: object, where: str) -> None:
    """Checks depth and keys; of a list or a mapping that stands in several places in each."""
    left = [(content, 0)]
    while left:
        value, depth = left.pop()
        if depth > DEEPEST:
            raise _too_deep(where)
        if isinstance(value, Mapping):
            wrong = next((key for key in value if not isinstance(key, str)), None)
            if wrong is not None or None in value:
                raise UsageError(f"{where}: key {str(wrong)[:40]} must be text; put it in quotes")
            left += [(item, depth + 1) for item in value.values()]
        elif isinstance(value, list):
            left += [(item, depth + 1) for item in value]
