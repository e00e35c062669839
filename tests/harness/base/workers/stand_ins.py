"""Stand-ins for driving: what workers do in tests. A module of its own, so that they can load it."""

import os
import signal
import time
from pathlib import Path


def square(number: int) -> tuple[int, int]:
    return number, number * number


def process_id(_: int) -> int:
    time.sleep(0.2)  # so that every worker gets some
    return os.getpid()


def square_and_threads(number: int) -> tuple[int, int, str | None]:
    return *square(number), os.environ.get("OPENBLAS_NUM_THREADS")


def die_the_first_time(item: tuple[int, Path]) -> int:
    """Item 3 kills its worker, once."""
    number, marker = item
    if number == 3 and not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def die_at_3(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def fail_at_3(number: int) -> int:
    if number == 3:
        raise ValueError("three")
    return number


def hang_after_the_first(item: tuple[int, Path]) -> int:
    """Leaves a file with its process's id, then hangs unless it is item 0; one more as it ends."""
    number, folder = item
    try:
        (folder / f"{number}.pid").write_text(str(os.getpid()))
        while number:
            time.sleep(0.05)
    finally:
        (folder / f"{number}.tidied").touch()
    return number
