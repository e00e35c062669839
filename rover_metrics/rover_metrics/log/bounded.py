"""JSON and YAML that others have written, read within bounds: what is larger or deeper is refused."""

import json
from pathlib import Path
from typing import Any

MOST_BYTES, MOST_DEPTH, MOST_DIGITS = 1 << 24, 50, 20  # of a file, of its nesting, of an integer


def read_json(path: Path) -> Any:  # noqa: ANN401 - any JSON value
    """Returns what a JSON file holds.

    Raises:
        OSError: It cannot be read.
        ValueError: It is no JSON, or beyond the bounds; the message says in one line why.
    """
    try:
        return json.loads(_content(path), parse_int=_integer)
    except RecursionError:
        raise ValueError(f"it is nested more than {MOST_DEPTH} deep") from None


def read_yaml(path: Path) -> Any:  # noqa: ANN401 - any YAML value
    """Returns what a YAML file holds; aliases are refused, as ROS refuses them.

    Raises:
        OSError: It cannot be read.
        ValueError: It is no YAML, or beyond the bounds; the message says in one line why.
    """
    from ruamel.yaml import YAML, events  # noqa: PLC0415 - analyze and the node do without it
    from ruamel.yaml.error import YAMLError  # noqa: PLC0415

    text, depth = _content(path).decode("utf-8"), 0
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            if isinstance(event, events.AliasEvent):
                raise ValueError(f"it has an alias (*{event.anchor}); write out what it stands for")
            if isinstance(event, events.ScalarEvent) and event.value.lstrip("+-").isdigit():
                _integer(event.value)
            depth += isinstance(event, events.CollectionStartEvent)
            depth -= isinstance(event, events.CollectionEndEvent)
            if depth > MOST_DEPTH:
                raise ValueError(f"it is nested more than {MOST_DEPTH} deep")
        return YAML(typ="safe").load(text)
    except (YAMLError, ValueError, TypeError, ArithmeticError) as error:  # TypeError: a list as a key
        raise ValueError(" ".join(str(error).split())) from error


def _content(path: Path) -> bytes:
    if not path.is_file():  # a FIFO would wait for its writer
        path.stat()
        raise ValueError("it is no file")
    with path.open("rb") as file:
        content = file.read(MOST_BYTES + 1)
    if len(content) > MOST_BYTES:
        raise ValueError(f"it is larger than {MOST_BYTES >> 20} MB")
    return content


def _integer(digits: str) -> int:
    if len(digits) > MOST_DIGITS:
        raise ValueError(f"it has an integer of {len(digits)} digits")
    return int(digits)
