"""Command lines: help with defaults, mistakes in one line, completion by the shell."""

import argparse
import math
import os
import re
from collections.abc import Iterable
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NoReturn

from rover_metrics.errors import RoverMetricsError, called, printable
from rover_metrics.number import number, whole

COMPLETED = "_ARGCOMPLETE"  # set while a shell completes a word: which of its words is the program
_NUMBERS = {"int": "a whole number", "float": "a number"}
NEARLY = 0.75  # of 1: so alike, one option is taken for a slip of the other
_MISTYPED = re.compile(r"invalid (int|float) value: (.*)")  # what argparse says
_UNKNOWN = re.compile(r"unrecognized arguments: (--[^\s=]+)")  # what argparse says too
_COMMAND = "required: COMMAND"  # and where a program of several commands is given none


def positive(text: str) -> float:
    """Converts a word of a command line to a number above 0; argparse reports any other word."""
    return _between(text, math.inf, "above 0")


def level(text: str) -> float:
    """Converts a word of a command line to a number between 0 and 1; argparse reports any other."""
    return _between(text, 1.0, "between 0 and 1, such as 0.95")


def _between(text: str, below: float, wanted: str) -> float:
    with suppress(ValueError):
        if 0.0 < (value := number(text)) < below:
            return value
    raise argparse.ArgumentTypeError(f"'{text}' is not valid; give a number {wanted}")


class HelpWithDefaults(argparse.HelpFormatter):
    """Help with the default of each option that has one; text of several lines stays as it is."""

    def _get_help_string(self, action: argparse.Action) -> str:
        text, default = action.help or "", action.default
        has_none = default is None or default is argparse.SUPPRESS or default in ("", [])
        if has_none or action.nargs == 0 or "default" in text:
            return text
        return f"{text}; default: {_as_typed(default)}".replace("%", "%%")

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        if "\n" not in text:
            return super()._fill_text(text, width, indent)
        return "".join(indent + line for line in text.splitlines(keepends=True))


def _as_typed(value: object) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, Iterable) and not isinstance(value, str):
        return " ".join(map(_as_typed, value))
    return str(value)


def _each(value: object) -> Iterable[object]:
    return value if isinstance(value, list | tuple) else ()


class OneLineParser(argparse.ArgumentParser):
    """A parser of command lines whose errors are one line that begins with the command's name.

    Its usage is that of the installed script (rover-run) where this is what was called.
    """

    def __init__(self, **options: Any) -> None:  # noqa: ANN401 - argparse's
        super().__init__(**{"formatter_class": HelpWithDefaults} | options)
        self._negative_number_matcher = re.compile(r"-\.?\d")  # or argparse takes -3,4 for an option
        self.register("type", int, whole)
        self.register("type", float, number)
        self._command = self.prog.removeprefix("python -m ").removeprefix("rover_metrics.")
        self._command = called(self._command)
        if self.prog.startswith("python -m "):  # no parser of a verb
            self.prog = called(self.prog)

    def parse_args(self, *args: Any, **options: Any) -> Any:  # noqa: ANN401 - argparse's
        """Parses as argparse does; while a shell completes a word, tells it the words and ends."""
        if COMPLETED in os.environ:
            from argcomplete import autocomplete  # noqa: PLC0415 - only shells need it

            autocomplete(self)
        return super().parse_args(*args, **options)

    def parse_known_args(self, *args: Any, **options: Any) -> Any:  # noqa: ANN401 - argparse's
        """Parses as argparse does; a file `-`, as elsewhere of standard input or output, is refused."""
        parsed, rest = super().parse_known_args(*args, **options)
        for action in self._actions:
            value = getattr(parsed, action.dest, None)
            if any(isinstance(one, Path) and str(one) == "-" for one in (value, *_each(value))):
                wrong = "'-' is not valid: no file is standard input or output; name one"
                self.error(str(argparse.ArgumentError(action, wrong)))
        return parsed, rest

    def error(self, message: str) -> NoReturn:
        """Prints the message and leaves with exit code 2."""
        line = printable(f"{self._command}: {self.mended(message)}; see --help")
        self.exit(RoverMetricsError.exit_code, f"{line}\n")

    def mended(self, message: str) -> str:
        """Returns what argparse complains of, with what is valid, or the option that is meant."""
        wrong = _MISTYPED.search(message)
        if wrong is not None:
            return f"{message[: wrong.start()]}{wrong[2]} is not valid; give {_NUMBERS[wrong[1]]}"
        if message.endswith(_COMMAND) and self._subparsers is not None:
            (commands,) = self._subparsers._group_actions  # noqa: SLF001 - argparse has it nowhere else
            return f"{message} ({', '.join(commands.choices or ())})"
        unknown = _UNKNOWN.match(message)
        near = get_close_matches(unknown[1], self._option_string_actions, 1, NEARLY) if unknown else []
        return "; did you mean ".join([message, *near])
