"""The command line of rover_metrics.analyze; each mistake is one line."""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

from rover_metrics.analysis.logs.log import AXES, DEFAULT_GAP
from rover_metrics.analysis.metric import ALL, METRICS
from rover_metrics.analysis.pairing import PAIRINGS
from rover_metrics.analysis.program import add_documents
from rover_metrics.analysis.statistics.series import DEFAULT_MULTIPLIER
from rover_metrics.analysis.study import PLOTS
from rover_metrics.parser import OneLineParser, level, positive

DEFAULT_INTERVAL = 1.0  # s


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Returns the options of a command line, of sys.argv if None.

    Words that make no sense end the program: one line that names the valid choices, exit code 2.
    """
    parser = _parser()
    options: argparse.Namespace = parser.parse_args(arguments)
    if options.plots is None:
        options.plots = ["comparison" if ALL in map(str.casefold, options.metrics) else "time_series"]
    if options.fixed_interval is None:
        options.normalize = options.normalize or "percentage"
        options.fixed_interval = DEFAULT_INTERVAL
    elif options.normalize not in (None, "fixed_interval"):
        parser.error(
            f"--fixed-interval has no effect with -n {options.normalize}; give -n fixed_interval"
        )
    options.normalize = options.normalize or "fixed_interval"
    for fault in _faults_of_groups(options):
        parser.error(fault)
    options.group_names = options.group_names or ["first", "versus"]
    options.unit, options.pair_by = options.unit or "log", options.pair_by or "seed"
    return options


def _faults_of_groups(options: argparse.Namespace) -> Iterator[str]:
    if not options.versus:
        for name in ("group_names", "unit", "pair_by"):
            if getattr(options, name) is not None:
                yield f"--{name.replace('_', '-')} has no effect without --versus LOG..."
    if shared := {*map(Path.resolve, options.logs)} & {*map(Path.resolve, options.versus)}:
        yield f"{min(shared)} is in both groups; each log belongs to one"
    if options.group_names and options.group_names[0] == options.group_names[1]:
        yield "--group-names must be two different names"
    if not "".join(options.group_names or ()).isprintable():
        yield "--group-names must be names that can be printed"
    if options.unit == "episode" and options.pair_by in ("seed", "order"):
        yield f"--pair-by {options.pair_by} pairs logs; give --unit log"


def _parser() -> OneLineParser:
    parser = OneLineParser(
        prog="python -m rover_metrics.analyze",
        description="Statistics and plots of metrics logs. Logs come before options that take lists.",
        epilog="Exit code: 0 if every log was read, 1 if any was skipped, 2 for wrong words or files.",
        allow_abbrev=False,
    )
    add = parser.add_argument
    logs = "CSV written by metrics_node, or a folder of them and of folders"
    add("logs", nargs="+", type=Path, metavar="LOG", help=logs)
    metrics = (
        f"what to report, of {' '.join(METRICS)}; or any column by its name, extended ones too; or "
        f"{ALL}: every column, with --versus those with the largest effect first; default: the codes"
    )
    add("-m", "--metrics", nargs="+", default=list(METRICS), metavar="CODE", help=metrics)
    plots = (
        f"what to draw, of {' '.join(PLOTS)}; none if none is named; "
        f"default: time_series, with -m {ALL} comparison"
    )
    add("-p", "--plots", "--plot-types", nargs="*", choices=PLOTS, metavar="PLOT", help=plots)
    axes = f"time axis of the plots, of {' '.join(AXES)}; default: percentage"
    add("-n", "--normalize", choices=AXES, metavar="AXIS", help=axes)
    interval = f"seconds per mean with -n fixed_interval; default: {DEFAULT_INTERVAL}"
    add("--fixed-interval", type=positive, metavar="S", help=interval)
    fences = "an outlier lies over K interquartile ranges beyond the quartiles; default: 1.5"
    add("--iqr-multiplier", type=positive, default=DEFAULT_MULTIPLIER, metavar="K", help=fences)
    removed = "leave outliers out of statistics and plots; without it they are only counted"
    add("--remove-outliers", action="store_true", help=removed)
    add("--save-outliers", action="store_true", help="write them to outliers.csv in the output folder")
    confidence = "of every interval, and 1 - P of every verdict; default: 0.95"
    add("--confidence-level", type=level, default=0.95, metavar="P", help=confidence)
    _add_comparison(parser)
    _add_output(parser)
    return parser


def _add_comparison(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    versus = "a second group of logs to compare with the first"
    add("--versus", nargs="+", type=Path, default=[], metavar="LOG", help=versus)
    names = "names of the two groups; default: first versus"
    add("--group-names", nargs=2, metavar=("FIRST", "SECOND"), help=names)
    unit = (
        "one observation of the comparison; default: log, for the episodes of one log share world, node "
        "and driver"
    )
    add("--unit", choices=("log", "episode"), help=unit)
    pairs = (
        "pair the logs of the two groups: seed: by the seeds in their records, if each has its partner; "
        "order: first with first, and so on; none: never; default: seed"
    )
    add("--pair-by", choices=PAIRINGS, help=pairs)
    gap = f"an episode ends where no row follows for longer than this; default: {DEFAULT_GAP}"
    add("--gap", type=positive, default=DEFAULT_GAP, metavar="S", help=gap)


def _add_output(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    names = ("-o", "--out", "--output", "--output-dir")
    folder = "folder for whatever is written; default: output"
    add(*names, dest="output", type=Path, default=Path("output"), metavar="DIR", help=folder)
    add("--csv", action="store_true", help="write every number to CSV files in the output folder")
    add("--latex", action="store_true", help="write the tables for LaTeX (booktabs) there, one a file")
    add_documents(parser)
