"""Files: read as YAML; whether one can be written, found out before the run; whole or not at all."""

import tempfile
from pathlib import Path
from typing import Any

from harness.base.errors import HarnessError, UsageError
from rover_metrics.log.files import whole_file

__all__ = ["check_target", "modified_ns", "read_mapping", "whole_file", "write_whole"]


def write_whole(
    path: Path, text: str, what: str = "", failure: type[HarnessError] = HarnessError
) -> None:
    """Writes a text as UTF-8; the file is there whole or not at all.

    Args:
        path: The file; it may exist.
        text: With the ends of its lines as they shall be.
        what: The text, for the message.
        failure: What is raised if it cannot be written.
    """
    try:
        with whole_file(path) as part:
            part.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise failure(f"cannot write {what and f'{what} to '}{path}: {error.strerror}") from error


def check_target(flag: str, target: Path, suffix: str = "") -> None:
    """Finds out before a run whether a file can be written.

    Args:
        flag: Where the user named it.
        target: The file; it may exist.
        suffix: How its name must end; any name will do without one.

    Raises:
        UsageError: It cannot, or the name ends otherwise.
    """
    if suffix and target.suffix.lower() != suffix:
        raise UsageError(f"{flag} '{target}': name a file that ends in {suffix}")
    try:
        if target.is_dir():
            raise UsageError(f"{flag} {target} is a folder; name a file")
        if not target.parent.is_dir():
            raise UsageError(f"{flag} {target}: there is no folder {target.parent}; create it first")
        with tempfile.TemporaryFile(dir=target.parent):
            pass  # os.access would not do: to root it says yes even in /proc
    except OSError as error:
        message = f"{flag} {target} cannot be written: {error.strerror}; choose another place"
        raise UsageError(message) from error


def read_mapping(path: Path) -> dict[str, Any]:
    """Returns the keys and values of a YAML file.

    Raises:
        UsageError: It cannot be read, is no YAML, or holds something else.
    """
    from ruamel.yaml import YAML  # noqa: PLC0415 - takes 25 ms, and most imports of this need no file
    from ruamel.yaml.error import YAMLError  # noqa: PLC0415

    try:
        content = YAML(typ="safe").load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}") from error
    except (YAMLError, ValueError) as error:
        raise UsageError(f"{path} is not valid YAML: {' '.join(str(error).split())}") from error
    if not isinstance(content, dict):
        raise UsageError(f"{path} must hold keys with values")
    return content


def modified_ns(path: Path) -> int:
    """Returns when a file was last written [ns]; 0 if there is none. Caches ask, to read it anew."""
    return path.stat().st_mtime_ns if path.exists() else 0
