"""Command: measure, side by side, and print ratios.

python -m benchmarks [name ...] [--hour] [--quick | --write]
"""

import argparse
import sys
from collections.abc import Sequence

from rich.console import Console

from benchmarks.measuring import FULL, QUICK, Effort, Table
from benchmarks.own_domain import own_domain
from benchmarks.readme import README, conditions, write_readme
from benchmarks.registry import BENCHMARKS, Benchmark
from benchmarks.show import printable
from harness.base.errors import HarnessError
from harness.base.interrupt import StopRequest
from rover_metrics.parser import OneLineParser


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = _parser()
    options = parser.parse_args(arguments)
    console = Console(width=None if sys.stdout.isatty() else 140)
    if options.list:
        for benchmark in BENCHMARKS.values():
            console.print(f"[bold]{benchmark.name:10}[/] {benchmark.question}")
        return 0
    if options.write and options.quick:
        parser.error("--write measures in full; leave out --quick")
    effort = QUICK if options.quick else FULL
    told = f"{conditions()} Medians of {effort.rounds} rounds."
    console.print(told, highlight=False)
    try:
        with StopRequest(), own_domain():  # else a signal would leave folders and nodes behind
            tables = _measured(_chosen(options), effort, console)
    except HarnessError as error:
        print(f"benchmarks: {error}", file=sys.stderr)
        return error.exit_code
    if options.write:
        write_readme(told, tables)
        console.print(f"written to {README}")
    return 0


def _chosen(options: argparse.Namespace) -> list[Benchmark]:
    if options.names:
        return [BENCHMARKS[name] for name in options.names]
    with_long_ones = options.hour or options.write
    return [b for b in BENCHMARKS.values() if with_long_ones or not b.takes_minutes]


def _measured(chosen: Sequence[Benchmark], effort: Effort, console: Console) -> dict[str, Table]:
    tables = {}
    for benchmark in chosen:
        with console.status(f"{benchmark.name}: {benchmark.question}"):
            table = tables[benchmark.name] = benchmark.measure(effort)
        console.print(printable(table))
    return tables


def _name(word: str) -> str:
    if word not in BENCHMARKS:
        message = f"benchmark '{word}' does not exist; available: {', '.join(BENCHMARKS)}"
        raise argparse.ArgumentTypeError(message)
    return word


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m benchmarks", description="Measures, side by side, and prints ratios."
    )
    parser.add_argument(
        "names", nargs="*", type=_name, metavar="name", help=f"{', '.join(BENCHMARKS)}; default: all"
    )
    parser.add_argument("--hour", action="store_true", help="memory over a simulated hour, too")
    parser.add_argument("--quick", action="store_true", help="a smoke test: the figures mean nothing")
    parser.add_argument("--write", action="store_true", help="into benchmarks/README.md, in full")
    parser.add_argument("--list", action="store_true", help="name the benchmarks")
    return parser


if __name__ == "__main__":
    sys.exit(main())
