"""Files that are there whole or not at all."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from harness.errors import UsageError


@contextlib.contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """A file beside the target that takes its place if all goes well; a link there is not followed."""
    handle, name = tempfile.mkstemp(dir=target.parent, suffix=".part")
    os.close(handle)
    part = Path(name)
    try:
        yield part
        part.chmod(0o644)
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)


def check_target(flag: str, target: Path, suffix: str) -> None:
    """Finds out before a run whether a file can be written.

    Args:
        flag: Where the user named it.
        target: The file; it may exist.
        suffix: How its name must end.

    Raises:
        UsageError: It cannot, or the name ends otherwise.
    """
    if target.suffix.lower() != suffix:
        raise UsageError(f"{flag} '{target}': name a file that ends in {suffix}")
    try:
        if target.is_dir():
            raise UsageError(f"{flag} {target} is a folder; name a file")
        if not target.parent.is_dir():
            raise UsageError(f"{flag} {target}: there is no folder {target.parent}; create it first")
        with tempfile.TemporaryFile(dir=target.parent):
            pass
    except OSError as error:
        raise UsageError(f"{flag} {target} cannot be written: {error.strerror}") from error
