"""The reader of files, YAML and JSON of rover_metrics, with errors that name the file."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from harness.base.errors import UsageError
from rover_metrics.log import documents
from rover_metrics.log.documents import LARGEST_JSON, DocumentError

LFS = b"version https://git-lfs"  # as the file begins that Git leaves where another is to be fetched
POINTER = "is only Git LFS's pointer to it"
FETCH = "git lfs pull fetches it"

__all__ = ["LARGEST_JSON", "parse_json", "read_bytes", "read_json", "read_mapping", "read_yaml"]


def read_bytes(path: Path, largest: int) -> bytes:
    """Returns the bytes of a file or a shell's pipe; UsageError if it cannot be read or is too large."""
    data: bytes = _named(str(path), lambda: documents.read_bytes(path, largest))
    if data.startswith(LFS):
        raise UsageError(f"{path} {POINTER}; {FETCH}")
    return data


def read_json(path: Path, largest: int = LARGEST_JSON) -> Any:  # noqa: ANN401 - whatever a file holds
    """Returns what a JSON file holds; UsageError if it is none, or has more than `largest` bytes."""
    return _named(str(path), lambda: documents.read_json(path, largest))


def parse_json(text: str | bytes, where: str) -> Any:  # noqa: ANN401
    """Returns what a JSON text from `where` holds; UsageError if it is none, or beyond a bound."""
    return _named(where, lambda: documents.parse_json(text))


def read_yaml(path: Path, *, with_places: bool = False) -> Any:  # noqa: ANN401
    """Returns what a YAML file holds, with its places as ruamel.yaml has them if asked for."""
    return _named(str(path), lambda: documents.read_yaml(path, with_places=with_places))


def read_mapping(path: Path, *, or_empty: bool = False) -> dict[str, Any]:
    """Returns the keys and values of a YAML file.

    Args:
        path: The file.
        or_empty: Whether one that holds nothing is valid: no keys.

    Raises:
        UsageError: It holds something else, or is beyond a bound.
    """
    content = read_yaml(path)
    if content is None and or_empty:
        return {}
    if not isinstance(content, dict):
        raise UsageError(f"{path} must hold keys with values")
    return content


def _named(where: str, read: Callable[[], Any]) -> Any:  # noqa: ANN401
    try:
        return read()
    except DocumentError as error:
        if isinstance(error.__cause__, OSError):
            raise UsageError(f"cannot read {where}: {error}") from error
        place = "".join(f":{number}" for number in error.place or ())
        raise UsageError(f"{where}{place}: {error}") from error
