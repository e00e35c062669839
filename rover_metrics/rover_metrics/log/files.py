"""Files that are there whole or not at all, and strict JSON."""

import contextlib
import math
import os
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any


@contextlib.contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Yields a file beside the target that replaces it if all goes well; a link is not followed."""
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=target.stem, suffix=".part")
    os.close(handle)
    part = Path(name)
    try:
        yield part
        part.chmod(0o644)  # mkstemp lets nobody else read
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)


def json_safe(value: Any, digits: int | None = None) -> Any:  # noqa: ANN401 - any JSON value
    """Returns a value as strict JSON knows it: infinite numbers and NaN are None, tuples are lists.

    Floats are rounded to `digits` decimals, if any are given.
    """
    if isinstance(value, Mapping):
        return {str(key): json_safe(item, digits) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [json_safe(item, digits) for item in value]
    if isinstance(value, float):
        if not math.isfinite(value):
            return None
        return value if digits is None else round(value, digits)
    return value
