"""What can go wrong, as types, and how commands tell it: in one line, with an exit code.

The edge of every program is here: `begin_program` before it loads its libraries, `run_program` around
its work. Needs Python alone, since what is missing is reported from here.
"""

import errno
import gc
import signal
import sys
from collections.abc import Callable, Iterable
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from types import TracebackType

# Extras by what they bring.
EXTRAS = {"av": "[video]", "rclpy": "[ros]", "sklearn": "[tune]", "laspy": "[cloud]"}
OWN = ("harness", "rover_metrics")
BLAMES: list[Callable[[BaseException], str]] = []  # tell which code of a user led to an error, or ""
SCRIPTS = ("rover-", "rover ")  # how the names of the installed commands begin: rover-run, rover run


def shown(text: str, most: int = 60) -> str:
    """Returns a text from elsewhere for a message: unprintable characters escaped, the rest cut off."""
    escaped = text[:most].encode("unicode_escape").decode() if not text.isprintable() else text[:most]
    return escaped if len(text) <= most else f"{escaped}..."


class KnownError(Exception):
    """A known mistake; its message is one line that names the valid choices or the mend."""

    exit_code = 2


class RoverMetricsError(KnownError):
    """What this package raises on purpose."""


class ParameterError(RoverMetricsError):
    """A ROS parameter of the wrong type or outside its range."""


class LogError(RoverMetricsError):
    """The metrics log cannot be created or written."""


class MissingRosError(RoverMetricsError, ImportError):
    """ROS 2 is not installed in this interpreter, or only half of it."""


def missing_ros(error: ImportError, *, is_program: bool) -> BaseException:
    """Returns what to raise where ROS 2 is missing, from what an import said.

    In a program, where nobody is there to catch it, a SystemExit after one line on stderr; else a
    MissingRosError.
    """
    message = (
        f"metrics_node needs ROS 2, but: {error}; source one (source /opt/ros/<distro>/setup.bash) "
        "or install its wheels into this environment (pip install 'rover-harness[ros]')"
    )
    if not is_program:
        return MissingRosError(message)
    print(message, file=sys.stderr)
    return SystemExit(MissingRosError.exit_code)


def begin_program(name: str) -> None:
    """Prepares a program for loading its libraries, which takes a second.

    Ctrl-C then ends it without showing where it was, and what it cannot load is one line. Garbage is
    collected from `run_program` on: what is loaded stays, and a sixth of its time would be spent on it.
    """
    gc.disable()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.excepthook = partial(_end_with_a_line, name)


def run_program(name: str, work: Callable[[], int]) -> int:
    """Does a program's work and returns the exit code; a known error is one line on stderr.

    The code is the work's or the KnownError's; 2 where a file cannot be used or a library is missing, 1
    where a plug-in has raised anything, of which the line is told.
    """
    if not gc.isenabled():
        gc.freeze()
        gc.enable()
    try:
        return work()
    except (KnownError, ImportError, OSError) as error:
        code = _reported(name, error)
        if code is None:
            raise
        return code
    except (Exception, SystemExit) as error:
        if not (reason := next(filter(None, (blame(error) for blame in BLAMES)), "")):
            raise
        complain(name, f"a plug-in failed: {reason}")
        return 1


# CPython (3.11 to 3.13) takes 16 kB from the system and gives it back in each call that happens to cross
# the end of the last 16: 3,600 times in a start of harness.run. Within a frame this large no call does.
run_program.__code__ = run_program.__code__.replace(co_stacksize=16_000)


def _end_with_a_line(
    name: str, kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    code = _reported(name, error)
    if code is not None:
        raise SystemExit(code)
    sys.__excepthook__(kind, error, trace)


def _reported(name: str, error: BaseException) -> int | None:
    """Prints the line of a known error and returns its exit code; None, without a line, of a bug."""
    line = _known_line(error)
    if line is None:
        return None
    complain(name, line)
    return getattr(error, "exit_code", KnownError.exit_code)


def _known_line(error: BaseException) -> str | None:
    """What there is to say of an error that is no bug of this project; None of one that is."""
    if isinstance(error, KnownError):
        return str(error)
    module = (getattr(error, "name", None) or "").partition(".")[0]
    if isinstance(error, ImportError) and module not in OWN:
        here = f"Python {sys.version.split()[0]}, {sys.executable}"
        return f"{error} ({here}); pip install 'rover-harness{EXTRAS.get(module, '')}'"
    if isinstance(error, FileNotFoundError) and error.filename is None:
        return "the current folder is gone; change to one that is there (cd)"
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT) and not error.filename:
        return f"cannot go on writing: {error.strerror}; free some, or write elsewhere"
    if isinstance(error, OSError) and error.filename is not None:
        return f"cannot use {error.filename}: {error.strerror}; name another place"
    return None


def reason_of(error: Exception) -> str:
    """Returns why a file cannot be used: in the system's words, or in those of the error."""
    return getattr(error, "strerror", None) or str(error)


def printable(text: str) -> str:
    """Returns a text with a ? for each control character: a file's name cannot make two lines."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def counted(number: int, noun: str, more: str = "") -> str:
    """Returns a number of things, such as '1 log' and '2 logs'.

    Args:
        number: How many.
        noun: One of them.
        more: What else is said of them, with a space in front.
    """
    return f"{number} {noun}{'' if number == 1 else 's'}{more}"


def unknown(kind: str, name: str, valid: Iterable[str]) -> str:
    """Returns the complaint about a name that does not exist, with the nearest that does, or all.

    Args:
        kind: What it is.
        name: As it was given.
        valid: All names that there are.
    """
    names = list(valid)
    near = get_close_matches(name, names, 1)
    hint = f"did you mean '{near[0]}'?" if near else f"available: {', '.join(names)}"
    return f"{kind} '{name}' does not exist; {hint}"


def called(name: str) -> str:
    """Returns what a program was called: as typed if that is an installed command, else its name."""
    typed = Path(sys.argv[0]).name
    return typed.removesuffix(".exe") if typed.startswith(SCRIPTS) else name


def sibling(module: str) -> str:
    """Returns another program by the kind of name typed for this one: rover tune, rover-tune, python -m.

    Args:
        module: E.g. harness.tune.
    """
    typed = called("")
    words = ("rover", module.rpartition(".")[2])
    return typed[len("rover")].join(words) if typed else f"python -m {module}"


def complain(name: str, text: str) -> None:
    """Prints one line on stderr that begins with what the program was called."""
    print(f"{called(name)}: {printable(text)}", file=sys.stderr)


def is_worth_a_line(before: int, now: int) -> bool:
    """Returns whether a count has passed a power of two on its way from `before` to `now`."""
    return now.bit_length() > before.bit_length()
