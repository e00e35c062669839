"""Files that are there whole or not at all, and strict JSON."""

import contextlib
import math
import os
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

ENDS = ("SIGINT", "SIGTERM", "SIGHUP")
PACKERS = {b"\x1f\x8b": "gzip", b"\x04\x22\x4d\x18": "lz4", b"BZh": "bzip2", b"PK\x03\x04": "zip"}


def packer_of(content: bytes) -> str:
    """Returns what has packed a file that begins so; "" for one that is not packed so."""
    return next((packer for begin, packer in PACKERS.items() if content.startswith(begin)), "")


@contextlib.contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Yields a file beside the target that replaces it if all goes well, and a link to a file too.

    A device or a pipe stays what it is: what was written is written into it. A signal that would end the
    process on the spot ends it after the unfinished file is gone.
    """
    is_special = target.exists() and not (target.is_file() or target.is_dir())
    folder = None if is_special else target.parent
    with _unwinding():
        handle, name = tempfile.mkstemp(dir=folder, prefix=target.stem, suffix=".part")
        os.close(handle)
        part = Path(name)
        try:
            yield part
            if is_special:
                with part.open("rb") as source, target.open("wb", buffering=0) as device:
                    shutil.copyfileobj(source, device)
                return
            part.chmod(0o644)  # mkstemp lets nobody else read
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)


def write_whole(target: Path, text: str) -> None:
    """Writes a text as UTF-8, its ends of lines as they are, into a `whole_file`.

    Bytes of file names that the locale could not read are what they are in UTF-8, or a replacement
    character; so is what no text may hold.
    """
    try:
        encoded = text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:  # a surrogate that stands for no byte
        encoded = text.encode("utf-8", "replace")
    with whole_file(target) as part:
        part.write_bytes(encoded.decode("utf-8", "replace").encode("utf-8"))


@contextlib.contextmanager
def _unwinding() -> Iterator[None]:
    """Within, signals that nobody handles raise SystemExit instead of ending the process at once.

    It does nothing beside rclpy, whose handlers are C's: Python takes them for none.
    """

    def leave(number: int, _: object) -> None:
        raise SystemExit(128 + number)

    ends = [getattr(signal, name) for name in ENDS if hasattr(signal, name)]
    may = threading.current_thread() is threading.main_thread() and "rclpy" not in sys.modules
    before = [n for n in ends if may and signal.getsignal(n) is signal.SIG_DFL]
    for number in before:
        signal.signal(number, leave)
    try:
        yield
    finally:
        for number in before:
            signal.signal(number, signal.SIG_DFL)


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
