"""What can go wrong, as types: the commands turn each into one line and an exit code."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TypeVar

from rover_metrics.errors import KnownError
from rover_metrics.errors import unknown as unknown  # noqa: PLC0414 - handed on

INSTALL_OPENGL = {"Linux": "install libegl1 libgl1 libgl1-mesa-dri (EGL) or libosmesa6 (OSMesa)"}
SOURCE_IT = "source the workspace that has it, where this is started"
INSTALL_ROS = "pip install 'rover-harness[ros]', source a ROS 2 installation"

T = TypeVar("T")


class HarnessError(KnownError):
    """Base of everything that this project raises on purpose."""

    exit_code = 1


class UsageError(HarnessError):
    """A known mistake of the caller; its message names the valid choices or the mend."""

    exit_code = 2


class RunFailed(HarnessError):
    """A run that could not be brought to its end; its message says what happened and when."""


class Diverged(RunFailed):
    """The simulation blew up: what it said before is not to be trusted either."""


class PluginFailed(RunFailed):
    """A part of somebody else has raised while it was used, or given what it must not."""


@contextmanager
def needing_ros(otherwise: str = "") -> Iterator[None]:
    """Imports of ROS 2 that fail become a UsageError; `otherwise` is what can be done without it."""
    try:
        yield
    except ImportError as error:
        raise UsageError(f"ROS 2 is not importable ({error}); {INSTALL_ROS}{otherwise}") from error


def find_named(kind: str, name: str, available: Mapping[str, T]) -> T:
    """Returns the value of that name.

    Args:
        kind: What it is, for the message.
        name: As the user gave it.
        available: All there are, by name.

    Raises:
        UsageError: There is none of that name; the message lists the names.
    """
    try:
        return available[name]
    except KeyError:
        names = ", ".join(available) or "none"
        raise UsageError(f"{kind} '{name}' does not exist; available: {names}") from None


def how_many(count: int, of: str) -> str:
    """Returns e.g. "1 contact", "2 contacts" or "1,000 contacts"."""
    return f"{count:,} {of}{'' if count == 1 else 's'}"


def told(error: Exception) -> str:
    """Returns what a library says of an error in one line of 120 characters at most, or its type."""
    return " ".join(str(error).split())[:120] or type(error).__name__


def repeated(names: Sequence[str]) -> str:
    """Returns the first name that is there more than once; "" if none is."""
    return next((name for name in names if names.count(name) > 1), "")
