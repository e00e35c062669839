"""Command: drive standard manoeuvres and compare what the rovers do with what their sources say.

    python -m harness.validate --robot leo --seed 1
    python -m harness.validate --robot rover_zero4wd --realism A.csv B.csv
    python -m harness.validate --robot husky --real RECORDINGS
    python -m harness.validate --rig --trials single_wheel.csv --plot soil.png

Parses, calls, prints; the work is in harness.validate.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.validate")

from rich.console import Console

from harness.base.errors import UsageError
from harness.base.files import check_target
from harness.robots import ROVERS, find_rover
from harness.soil.soils import SOILS, find_soil
from rover_metrics.errors import OneLineParser, complain
from rover_metrics.sheet.console import PlainConsole
from rover_metrics.sheet.render import terminal
from rover_metrics.sheet.sheet import Sheet


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 0, 1 after a miss, 2 for bad arguments."""
    options = _parser().parse_args(arguments)
    return run_program("harness.validate", lambda: _validate(options, PlainConsole()))


def _validate(options: argparse.Namespace, console: Console) -> int:
    if options.seed < 0:
        raise UsageError(f"seed {options.seed} is not valid; give a whole number from 0 up")
    if options.realism and options.robot is None:
        raise UsageError("--realism needs --robot, the rover that the logs are of")
    if (options.trials or options.plot or options.pressing) and not options.rig:
        raise UsageError("--trials, --plot and --pressing need --rig")
    if options.plot and not options.trials:
        raise UsageError("--plot needs --trials, the measured points")
    if options.plot:
        check_target("--plot", options.plot, ".png")
    if options.pressing and options.trials:
        raise UsageError("--pressing and --trials are of two tests; give one of them")
    if options.real is not None and options.robot is None:
        raise UsageError("--real needs --robot, the rover that the recordings are of")
    if options.rig:
        _rig(options, console)
        return 0
    if options.real is not None:
        return _print_misses(_real(options, console))
    return _print_misses(_realism(options, console) if options.realism else _suite(options, console))


def _print_misses(misses: Sequence[str]) -> int:
    if misses:
        complain("harness.validate", f"missed {'; '.join(misses)}")
    return 1 if misses else 0


def _suite(options: argparse.Namespace, console: Console) -> Sequence[str]:
    from harness.validate.suite import print_table, validate  # noqa: PLC0415 - not for --help

    rovers = ROVERS.values() if options.robot is None else [find_rover(options.robot)]
    misses = []
    for rover in rovers:
        with console.status(f"driving {rover.name}"):
            checks = validate(rover, options.seed)
        print_table(console, rover.name, checks)
        misses += [f"{rover.name}: {check.quantity}" for check in checks if not check.passed]
    return misses


def _realism(options: argparse.Namespace, console: Console) -> Sequence[str]:
    from harness.validate.realism import compare, print_comparison  # noqa: PLC0415 - not for --help

    find_rover(options.robot)
    with console.status(f"driving {options.robot} for ten minutes"):
        comparison = compare(options.realism, options.robot, options.seed)
    print_comparison(console, comparison)
    return comparison.missed


def _real(options: argparse.Namespace, console: Console) -> Sequence[str]:
    from harness.recordings.tables import recordings_of  # noqa: PLC0415 - not for --help
    from harness.validate.real.table import compare as compare_real  # noqa: PLC0415
    from harness.validate.suite import print_table  # noqa: PLC0415

    rover = find_rover(options.robot)
    if not options.real.is_dir():
        print(f"harness.validate: {options.real} is not there: nothing is compared", file=sys.stderr)
        return []
    recordings = recordings_of(options.real, rover.controller_radius)
    with console.status(f"driving {rover.name} as {len(recordings)} recordings"):
        checks, notes = compare_real(rover, recordings, options.seed)
    print_table(console, f"{rover.name} beside {options.real}", checks)
    print(*notes, sep="\n")
    return [check.quantity for check in checks if not check.passed]


def _rig(options: argparse.Namespace, console: Console) -> None:
    from harness.validate import pressing, single_wheel  # noqa: PLC0415 - not for --help

    soil = find_soil(options.soil)
    if options.trials is None:
        rovers = list(ROVERS.values()) if options.robot is None else [find_rover(options.robot)]
        header = ("stalls at [deg]", *(rover.name for rover in rovers))
        soils = {**SOILS, options.soil: soil}
        _print_sheet(console, header, single_wheel.stall_table(soils, rovers))
        depths = (f"{1e3 * depth:.0f} mm [N]" for depth in pressing.DEPTHS)
        found = pressing.measured(options.pressing) if options.pressing else {}
        _print_sheet(console, ("wheel pressed to", *depths), pressing.table(soils, found))
        return
    trials, notes = single_wheel.read_trials(options.trials)
    for note in notes:
        print(note)
    errors = single_wheel.judge(trials, single_wheel.predict(soil, trials))
    if not errors:
        steepest = f"{single_wheel.STEEPEST_DEG:g}"
        raise UsageError(f"no trial of {options.trials} has a slip angle of up to {steepest} degrees")
    for e in errors:
        sunk = f", {e.sunk} of them sunk in whole" if e.sunk else ""
        print(
            f"{e.wheel:9} {e.trials:14}  n {e.n:3}  RMSE of sinkage {1e3 * e.sinkage:.2f} mm, "
            f"tractive {e.tractive:.2f} N, lateral {e.lateral:.2f} N{sunk}"
        )
    if options.plot:
        single_wheel.plot(options.plot, soil, trials)


def _print_sheet(console: Console, header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    for part in terminal([Sheet(tuple(header), tuple(map(tuple, rows)))], console.width):
        console.print(part)


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.validate",
        description="Drives standard manoeuvres and compares the rovers with their sources.",
    )
    about = f"{', '.join(ROVERS)}, or a folder (docs/robots.md); default: all that ship"
    parser.add_argument("--robot", metavar="NAME|FOLDER", help=about)
    parser.add_argument(
        "--seed", type=int, default=0, metavar="N", help="headings and the unevenness of the floor"
    )
    parser.add_argument(
        "--realism",
        nargs=2,
        type=Path,
        metavar=("A.csv", "B.csv"),
        help="compare a 10-minute run with two logs recorded of that rover instead",
    )
    parser.add_argument(
        "--real",
        type=Path,
        metavar="FOLDER",
        help="compare with real recordings (CSV) instead; docs/real_rovers.md; default: none",
    )
    parser.add_argument(
        "--rig", action="store_true", help="draw a single wheel through soil instead; docs/soil.md"
    )
    parser.add_argument(
        "--trials",
        type=Path,
        metavar="FILE.csv",
        help="of --rig: measured trials to compare it with; default: the slopes at which rovers stall",
    )
    parser.add_argument(
        "--plot",
        type=Path,
        metavar="FILE.png",
        help="of --trials: draw curves over points; default: no picture",
    )
    parser.add_argument(
        "--pressing",
        type=Path,
        metavar="FILE.csv",
        help="of --rig: wheels that were pressed, not turned, to print beside the soils; default: none",
    )
    soils = ", ".join(SOILS)
    parser.add_argument(
        "--soil",
        default="dry_sand",
        metavar="NAME|FILE",
        help=f"of --rig: {soils}, or a YAML file; default: dry_sand",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
