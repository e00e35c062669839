"""Command: make a rover of a URDF or SDF, and tell what is odd about a rover.

    python -m harness.robot new my_rover --from robot.urdf
    python -m harness.robot check my_rover --picture my_rover.png
    python -m harness.robot schema > rover.schema.json

Parses, calls, prints; the work is in harness.robots.urdf and harness.validate.checkup.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from shutil import copy
from typing import TYPE_CHECKING

from harness.base.edge import begin_program, loading, run_program

if __name__ == "__main__":
    begin_program("harness.robot")

from rich.console import Console

from harness.base.errors import UsageError
from harness.base.opengl import keep_opengl_out
from harness.cli.sheets import add_files, files_of, write_sheets
from harness.robots.urdf.templates import TEMPLATES, urdf_of
from rover_metrics.errors import complain, shown, sibling
from rover_metrics.parser import OneLineParser
from rover_metrics.sheet.console import PlainConsole

if TYPE_CHECKING:
    from harness.robots.urdf.folder import Written

SHOWN = 3.0  # [s] of driving in a picture
NEXT = "next: {1} check {0}; then {2} --robot {0}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 0, 1 if something is odd, 2 for bad arguments."""
    options = _parser().parse_args(arguments)
    keep_opengl_out()  # before MuJoCo is loaded
    return run_program("harness.robot", lambda: int(options.act(options, PlainConsole())))


def _new(options: argparse.Namespace, console: Console) -> int:
    with loading():
        from harness.robots.urdf.folder import write_folder
    folder = options.out or Path(options.name)
    sides = {side: tuple(filter(None, getattr(options, side).split(","))) for side in ("left", "right")}
    with _source(options) as source:
        written = write_folder(
            options.name,
            source,
            folder,
            folders=options.resource_path,
            trust_xacro=options.trust_xacro,
            **sides,
        )
        if options.template:
            copy(source, written.folder)
    _print(written, console)
    return 0


@contextmanager
def _source(options: argparse.Namespace) -> Iterator[Path]:
    """Yields the URDF that a rover is made of: the user's, or that of a template."""
    if options.source is not None:
        yield options.source
        return
    from harness.robots.urdf.folder import NAME, NAMES

    with tempfile.TemporaryDirectory(prefix="rover-harness-") as folder:
        urdf = Path(folder) / f"{options.name}.urdf"
        if not NAME.fullmatch(options.name):
            raise UsageError(f"name '{shown(options.name)}' is not valid; give {NAMES}")
        urdf.write_text(urdf_of(options.name, TEMPLATES[options.template]), encoding="utf-8")
        yield urdf


def _print(written: "Written", console: Console) -> None:
    rover = written.rover
    size = f"track {rover.track:.3g} m, wheelbase {rover.wheelbase:.3g} m"
    lines = [
        *(f"note: {note}" for note in written.notes),
        *(f"guess: {guess}" for guess in written.guesses),
        f"{rover.name}: {rover.summary}; {size}, {rover.top_speed:.3g} m/s",
        f"written: {written.folder} (rover.yaml, {rover.model})",
        NEXT.format(written.folder, sibling("harness.robot"), sibling("harness.run")),
    ]
    for line in lines:
        console.print(line, soft_wrap=True)


def _check(options: argparse.Namespace, console: Console) -> int:
    with loading():
        from harness.cli.console import counted
        from harness.robots import find_rover
        from harness.spec.run import Run
        from harness.validate.checkup import check_up
        from harness.validate.suite import print_table, sheet_of
        from harness.view.drawing import Drawing

    rover, files = find_rover(options.rover), files_of(options)
    run = Run.of(robot=options.rover, terrain="flat", driver="figure8", duration=SHOWN)
    with Drawing(options.picture, None, lidar=False, backend=keep_opengl_out()) as drawing:
        if drawing.wanted:
            drawing.prepare(run)
        with console.status(f"driving {rover.name}"):
            checks = check_up(rover)
        title = f"{rover.name}: {rover.summary}"
        print_table(console, title, checks, missed="odd")
        write_sheets(files, title, [sheet_of(title, checks, "odd")])
        if drawing.wanted:
            drawing.drive(run)
            with counted(console, "drawing") as show:
                for path in drawing.finish(show):
                    console.print(f"drawn: {path}", soft_wrap=True)
    odd = [check for check in checks if not check.passed]
    for check in odd:
        complain("harness.robot", f"odd: {check.quantity}: {check.expected.source}")
    return 1 if odd else 0


def _schema(_: argparse.Namespace, __: Console) -> int:
    from harness.robots.spec import schema

    sys.stdout.write(schema())
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.robot", description="Rovers of your own: docs/robots.md."
    )
    commands = parser.add_subparsers(
        required=True, metavar="COMMAND", parser_class=OneLineParser, help="COMMAND --help tells more"
    )
    new = commands.add_parser("new", help="make a folder for --robot of a URDF or a model in SDF")
    new.set_defaults(act=_new)
    new.add_argument("name", metavar="NAME", help="of the rover")
    made = new.add_mutually_exclusive_group(required=True)
    about = "the URDF, SDF or folder of a Gazebo model; meshes beside it or above; or give --template"
    made.add_argument("--from", dest="source", type=Path, metavar="FILE", help=about)
    kinds = "; ".join(f"{name}, {template.summary}" for name, template in TEMPLATES.items())
    about = f"begin with one of these, whose URDF is put into the folder too: {kinds}; default: none"
    made.add_argument("--template", choices=TEMPLATES, default="", metavar="NAME", help=about)
    new.add_argument("--out", type=Path, metavar="FOLDER", help="to be made; default: NAME")
    for side in ("left", "right"):
        about = f"joints of the wheels on the {side}, front to rear; found by their places if left out"
        new.add_argument(f"--{side}", default="", metavar="J1,J2,...", help=about)
    about = "holds meshes, or packages of them, that are not beside the URDF or above it; default: none"
    new.add_argument(
        "--resource-path", action="append", type=Path, default=[], metavar="DIR", help=about
    )
    about = "take xacro too, which runs Python of whoever wrote it and what it includes (extra [xacro])"
    new.add_argument("--trust-xacro", action="store_true", help=about)
    check = commands.add_parser(
        "check", help="compile a rover, drive it on flat ground, tell what is odd"
    )
    check.set_defaults(act=_check)
    check.add_argument("rover", metavar="FOLDER", help="or the name of a rover that ships")
    check.add_argument("--picture", type=Path, metavar="FILE.png", help="draw it")
    add_files(check)
    printed = commands.add_parser("schema", help="print the JSON schema of rover.yaml, for editors")
    printed.set_defaults(act=_schema)
    return parser


if __name__ == "__main__":
    sys.exit(main())
