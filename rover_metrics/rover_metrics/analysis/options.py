"""The command line of rover_metrics.analyze; every mistake is told in one line."""

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from rover_metrics.analysis.logs.episodes import DEFAULT_GAP
from rover_metrics.analysis.logs.time_axis import AXES
from rover_metrics.analysis.metric import METRICS
from rover_metrics.analysis.output import PLOTS
from rover_metrics.analysis.statistics.outliers import DEFAULT_MULTIPLIER
from rover_metrics.errors import RoverMetricsError

DEFAULT_INTERVAL = 1.0  # s


class UsageError(RoverMetricsError):
    """A wrong command line."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise UsageError(" ".join(message.split()))


def positive(text: str) -> float:
    """Parse a finite number above 0."""
    value = _number(text)
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
    return value


def level(text: str) -> float:
    """Parse a level of confidence."""
    value = _number(text)
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number between 0 and 1, such as 0.95")
    return value


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


_OPTIONS: dict[tuple[str, ...], dict[str, Any]] = {
    ("-m", "--metrics"): {
        "nargs": "+",
        "type": str.upper,
        "choices": tuple(METRICS),
        "default": list(METRICS),
        "metavar": "CODE",
        "help": f"what to report, of {' '.join(METRICS)}; default: all",
    },
    ("-p", "--plots"): {
        "nargs": "*",
        "choices": PLOTS,
        "default": ["time_series"],
        "metavar": "PLOT",
        "help": f"what to draw, of {' '.join(PLOTS)}; none if none is named; default: time_series",
    },
    ("-n", "--normalize"): {
        "choices": AXES,
        "metavar": "AXIS",
        "help": f"time axis of the plots, of {' '.join(AXES)}; default: percentage",
    },
    ("--fixed-interval",): {
        "type": positive,
        "metavar": "S",
        "help": "seconds per mean with -n fixed_interval; default: 1.0",
    },
    ("--iqr-multiplier",): {
        "type": positive,
        "default": DEFAULT_MULTIPLIER,
        "metavar": "K",
        "help": "an outlier lies over K interquartile ranges beyond the quartiles; default: 1.5",
    },
    ("--remove-outliers",): {
        "action": "store_true",
        "help": "leave outliers out of statistics and plots; without it they are only counted",
    },
    ("--save-outliers",): {
        "action": "store_true",
        "help": "write them to outliers.csv in the output folder",
    },
    ("--confidence-level",): {
        "type": level,
        "default": 0.95,
        "metavar": "P",
        "help": "of every interval, and 1 - P of every verdict; default: 0.95",
    },
    ("--versus",): {
        "nargs": "+",
        "type": Path,
        "default": [],
        "metavar": "LOG",
        "help": "a second group of logs to compare with the first",
    },
    ("--group-names",): {
        "nargs": 2,
        "metavar": ("FIRST", "SECOND"),
        "help": "names of the two groups; default: first versus",
    },
    ("--unit",): {
        "choices": ("log", "episode"),
        "help": "one observation of the comparison; default: log, for the episodes of one log share "
        "world, node and driver",
    },
    ("--gap",): {
        "type": positive,
        "default": DEFAULT_GAP,
        "metavar": "S",
        "help": "an episode ends where no row follows for longer than this; default: 10.0",
    },
    ("-o", "--output"): {
        "type": Path,
        "default": Path("output"),
        "metavar": "DIR",
        "help": "folder for plots and outliers; default: output",
    },
    ("--json",): {"action": "store_true", "help": "print JSON instead of tables"},
}


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Parse the command line.

    Args:
        arguments: Words; sys.argv if None.

    Raises:
        UsageError: The words make no sense; the message names the valid choices.
    """
    options = _parser().parse_args(arguments)
    options.metrics = list(dict.fromkeys(options.metrics))
    if options.normalize is None:
        options.normalize = "percentage" if options.fixed_interval is None else "fixed_interval"
    elif options.fixed_interval is not None and options.normalize != "fixed_interval":
        raise UsageError(
            f"--fixed-interval has no effect with -n {options.normalize}; give -n fixed_interval"
        )
    if options.fixed_interval is None:
        options.fixed_interval = DEFAULT_INTERVAL
    _check_groups(options)
    return options


def _check_groups(options: argparse.Namespace) -> None:
    if not options.versus:
        for name in ("group_names", "unit"):
            if getattr(options, name) is not None:
                raise UsageError(f"--{name.replace('_', '-')} has no effect without --versus LOG...")
    shared = {path.resolve() for path in options.logs} & {path.resolve() for path in options.versus}
    if shared:
        raise UsageError(f"{min(shared)} is in both groups; each log belongs to one")
    options.group_names = options.group_names or ["first", "versus"]
    if options.group_names[0] == options.group_names[1]:
        raise UsageError("--group-names must be two different names")
    if not "".join(options.group_names).isprintable():
        raise UsageError("--group-names must be names that can be printed")
    options.unit = options.unit or "log"


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="python -m rover_metrics.analyze",
        description="Statistics and plots of metrics logs. Logs come before options that take lists.",
        epilog="Exit code: 0 if every log was analysed, 1 if any was skipped, 2 for wrong arguments.",
        allow_abbrev=False,
    )
    parser.add_argument("logs", nargs="+", type=Path, metavar="LOG", help="CSV written by metrics_node")
    for flags, settings in _OPTIONS.items():
        parser.add_argument(*flags, **settings)
    return parser
