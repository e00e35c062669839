"""Command: drive standard manoeuvres and compare what the rovers do with what their sources say.

    python -m harness.validate --robot leo --seed 1
    python -m harness.validate --robot rover_zero4wd --realism A.csv B.csv
    python -m harness.validate --robot husky --real RECORDINGS
    python -m harness.validate --rig --trials single_wheel.csv --plot soil.png

Parses, calls, prints; the work is in harness.validate.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, loading, run_program

if __name__ == "__main__":
    begin_program("harness.validate")

from rich.console import Console

from harness.base.errors import UsageError
from harness.base.files import check_target
from harness.cli.sheets import add_files, files_of, write_sheets
from harness.robots import ROVERS, find_rover
from harness.soil.soils import SOILS, find_soil
from rover_metrics.errors import complain
from rover_metrics.parser import OneLineParser
from rover_metrics.sheet.console import PlainConsole
from rover_metrics.sheet.render import terminal
from rover_metrics.sheet.sheet import NONE, Sheet

Outcome = tuple[Sequence[Sheet], Sequence[str]]  # tables, and what was missed


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 0, 1 after a miss, 2 for bad arguments."""
    options = _parser().parse_args(arguments)
    return run_program("harness.validate", lambda: _validate(options, PlainConsole()))


def _validate(options: argparse.Namespace, console: Console) -> int:
    nameless, of_rig = options.robot is None, options.trials or options.plot or options.pressing
    for is_wrong, mend in (
        (options.seed < 0, f"seed {options.seed} is not valid; give a whole number from 0 up"),
        (options.realism and nameless, "--realism needs --robot, the rover that the logs are of"),
        (of_rig and not options.rig, "--trials, --plot and --pressing need --rig"),
        (options.plot and not options.trials, "--plot needs --trials, the measured points"),
        (
            options.pressing and options.trials,
            "--pressing and --trials are of two tests; give one of them",
        ),
        (options.real and nameless, "--real needs --robot, the rover that the recordings are of"),
    ):
        if is_wrong:
            raise UsageError(mend)
    if options.plot:
        check_target("--plot", options.plot, ".png")
    files = files_of(options)
    kinds = (options.rig, _rig), (options.real, _real), (options.realism, _realism), (True, _suite)
    sheets, misses = next(work for given, work in kinds if given)(options, console)
    write_sheets(files, "Validation", sheets)
    if misses:
        complain("harness.validate", f"missed {'; '.join(misses)}")
    return 1 if misses else 0


def _suite(options: argparse.Namespace, console: Console) -> Outcome:
    with loading():
        from harness.cli.console import counted
        from harness.validate.suite import print_table, sheet_of, validate

    rovers = ROVERS.values() if options.robot is None else [find_rover(options.robot)]
    sheets, misses = [], []
    for rover in rovers:
        with counted(console, f"driving {rover.name}") as show:
            checks = validate(rover, options.seed, show)
        print_table(console, rover.name, checks)
        sheets.append(sheet_of(rover.name, checks))
        misses += [f"{rover.name}: {check.quantity}" for check in checks if not check.passed]
    return sheets, misses


def _realism(options: argparse.Namespace, console: Console) -> Outcome:
    with loading():
        from harness.validate.realism import compare, print_comparison, sheets_of

    find_rover(options.robot)
    with console.status(f"driving {options.robot} for ten minutes"):
        comparison = compare(options.realism, options.robot, options.seed)
    print_comparison(console, comparison)
    return sheets_of(comparison), comparison.missed


def _real(options: argparse.Namespace, console: Console) -> Outcome:
    with loading():
        from harness.validate.real.table import compare as compare_real
        from harness.validate.recordings.tables import recordings_of
        from harness.validate.suite import print_table, sheet_of

    rover = find_rover(options.robot)
    if not options.real.exists():
        print(f"harness.validate: {options.real} is not there: nothing is compared", file=sys.stderr)
        return (), ()
    recordings = recordings_of(options.real, rover.controller_radius)
    with console.status(f"driving {rover.name} as {len(recordings)} recordings"):
        checks, notes = compare_real(rover, recordings, options.seed)
    title = f"{rover.name} beside {options.real}"
    print_table(console, title, checks)
    for note in notes:
        print(note)
    return [sheet_of(title, checks)], [check.quantity for check in checks if not check.passed]


def _rig(options: argparse.Namespace, console: Console) -> Outcome:
    with loading():
        from harness.validate import pressing, single_wheel

    soil = find_soil(options.soil)
    if options.trials is None:
        rovers = list(ROVERS.values()) if options.robot is None else [find_rover(options.robot)]
        header = ("stalls at [deg]", *(rover.name for rover in rovers))
        soils = {**SOILS, options.soil: soil}
        depths = (f"{1e3 * depth:.0f} mm [N]" for depth in pressing.DEPTHS)
        measured = pressing.measured(options.pressing) if options.pressing else {}
        sheets = (
            Sheet(header, tuple(single_wheel.stall_table(soils, rovers)), "Slopes"),
            Sheet(("wheel pressed to", *depths), tuple(pressing.table(soils, measured)), "Pressing"),
        )
        console.print(*terminal(sheets, console.width), sep="\n")
        return sheets, ()
    trials, notes = single_wheel.read_trials(options.trials)
    for note in notes:
        print(note)
    errors = single_wheel.judge(trials, single_wheel.predict(soil, trials))
    if not errors:
        steepest = f"{single_wheel.STEEPEST_DEG:g}"
        raise UsageError(f"no trial of {options.trials} has a slip angle of up to {steepest} degrees")
    rows = (  # at 80 columns, too
        {
            "wheel": f"{e.wheel} {e.trials}", "n": f"{e.n}", "sinkage [mm]": _rmse(1e3 * e.sinkage),
            "tractive [N]": _rmse(e.tractive), "lateral [N]": _rmse(e.lateral), "sunk": f"{e.sunk}",
        }
        for e in errors
    )  # fmt: skip
    sheet = Sheet.of(rows, "RMSE of a single wheel")
    console.print(*terminal([sheet], console.width), sep="\n")
    if options.plot:
        single_wheel.plot(options.plot, soil, trials)
    return [sheet], ()


def _rmse(error: float) -> str:
    """An error of one quantity as a cell; a dash of what no trial has measured."""
    return NONE if math.isnan(error) else f"{error:.2f}"


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.validate",
        description="Drives standard manoeuvres and compares the rovers with their sources.",
    )
    about = f"{', '.join(ROVERS)}, or a folder (docs/robots.md); default: all that ship"
    parser.add_argument("--robot", metavar="NAME|FOLDER", help=about)
    about = "headings and the unevenness of the floor"
    parser.add_argument("--seed", type=int, default=0, metavar="N", help=about)
    about = "compare a 10-minute run with two logs recorded of that rover instead"
    parser.add_argument("--realism", nargs=2, type=Path, metavar=("A.csv", "B.csv"), help=about)
    about = "compare with real recordings (CSV) instead; docs/real_rovers.md; default: none"
    parser.add_argument("--real", type=Path, metavar="FOLDER", help=about)
    about = "draw a single wheel through soil instead; docs/soil.md"
    parser.add_argument("--rig", action="store_true", help=about)
    about = "of --rig: measured trials to compare it with; default: the slopes at which rovers stall"
    parser.add_argument("--trials", type=Path, metavar="FILE.csv", help=about)
    about = "of --trials: draw curves over points; default: no picture"
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help=about)
    about = "of --rig: wheels that were pressed, not turned, to print beside the soils; default: none"
    parser.add_argument("--pressing", type=Path, metavar="FILE.csv", help=about)
    about = f"of --rig: {', '.join(SOILS)}, or a YAML file; default: dry_sand"
    parser.add_argument("--soil", default="dry_sand", metavar="NAME|FILE", help=about)
    add_files(parser)
    return parser


if __name__ == "__main__":
    sys.exit(main())
