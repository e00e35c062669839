"""Command: prove on this machine that runs are deterministic and lose nothing.

    python -m harness.check

Runs one seed twice in this process, once in a fresh one and once through ROS, and another seed, and
compares hashes. Exit code 0: proven. 1: disproven, or a run failed. 2: not checked as asked, because
an argument is wrong or because ROS is missing and was not left out with --no-ros.
"""

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from harness.base.edge import begin_program, loading, run_program

if __name__ == "__main__":
    begin_program("harness.check")

from rich.console import Console

from harness.base.errors import INSTALL_ROS, UsageError
from harness.base.interrupt import StopRequest
from harness.cli.sheets import add_files, files_of, write_sheets
from harness.robots import ROVERS
from harness.spec.rover import DEFAULT_NOISE
from harness.spec.run import Run
from rover_metrics.errors import complain
from rover_metrics.parser import OneLineParser
from rover_metrics.sheet.console import PlainConsole
from rover_metrics.sheet.render import terminal
from rover_metrics.sheet.sheet import Sheet

if TYPE_CHECKING:
    from harness.episode.fingerprint import Fingerprint

DEFAULT_DURATION = 20.0  # [s]
SHORTEST_DURATION = 5.0  # [s]: two seeds may need that long to show different rows
RUNS = 5  # that are compared
HASH_DIGITS = 8  # as many as are shown; all 64 are compared


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of the table.

    Attributes:
        result: None if the run was skipped.
        verdict: What the comparison says.
        passed: Whether the proof holds so far.
    """

    run: str
    result: "Fingerprint | None"
    verdict: str
    passed: bool


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    return run_program("harness.check", lambda: _prove(options, PlainConsole()))


def _prove(options: argparse.Namespace, console: Console) -> int:
    run, files, findings = _run(options), files_of(options), list[Finding]()
    with loading():
        from harness.cli.console import counted
    title = f"{run.rover.robot} on {run.world.terrain}"
    with StopRequest() as stop, counted(console, title) as show:
        for finding in _check(run, stop, with_ros=not options.no_ros):
            findings.append(finding)
            show(len(findings), RUNS)
    sheets = [_sheet(run, findings)]
    console.print(*terminal(sheets, console.width), sep="\n")
    write_sheets(files, "Repetition", sheets)
    if all(finding.passed for finding in findings):
        console.print(proven(run, findings), soft_wrap=True)
    return _exit_code(findings, ros_was_asked_for=not options.no_ros)


def _check(run: Run, stop: StopRequest, *, with_ros: bool) -> Iterator[Finding]:
    with loading():
        from harness.episode.direct import run_direct
        from harness.episode.fingerprint import direct_in_fresh_process, fingerprint

    reference = fingerprint(run_direct, run, stop)
    yield Finding("this process", reference, "reference", passed=True)
    yield _judged("again", fingerprint(run_direct, run, stop), reference)
    yield _judged("fresh process", direct_in_fresh_process(run), reference)
    yield _ros_finding(run, stop, reference) if with_ros else _skipped("--no-ros")
    other = run.but(seed=run.seed + 1)
    yield _judged(f"seed {other.seed}", fingerprint(run_direct, other, stop), reference, equal=False)


def _judged(run: str, result: "Fingerprint", reference: "Fingerprint", *, equal: bool = True) -> Finding:
    """Compares a run with the reference, to which it must be equal, or else different."""
    if result.lost:
        return Finding(run, result, f"LOST {result.lost} messages", passed=False)
    same = (result.stream == reference.stream, result.csv == reference.csv)
    if equal:
        return Finding(run, result, "equal" if all(same) else "DIFFERENT", passed=all(same))
    return Finding(run, result, "SAME AS REFERENCE" if any(same) else "different", passed=not any(same))


def _ros_finding(run: Run, stop: StopRequest, reference: "Fingerprint") -> Finding:
    from harness.episode.fingerprint import fingerprint

    try:
        # As in harness.run, the one import of rclpy: everything else works where there is none.
        from harness.ros.session import run_through_ros
    except ImportError as error:
        return _skipped(f"ROS 2 is not importable ({error})")
    # Apart from any rover or simulation in the same domain.
    namespace = f"/harness_check_{os.getpid()}"
    remapping = ("-r", f"__ns:={namespace}", "-r", f"/clock:={namespace}/clock")
    ros_args = ("--ros-args", *remapping, "--log-level", "warn")
    return _judged("through ROS 2", fingerprint(run_through_ros, run, stop, ros_args), reference)


def _skipped(reason: str) -> Finding:
    return Finding("through ROS 2", None, f"skipped: {reason}", passed=True)


def _sheet(run: Run, findings: Sequence[Finding]) -> Sheet:
    rows = []
    for finding in findings:
        cells = ["-"] * 5
        if (result := finding.result) is not None:
            cells = [f"{count:,}" for count in (result.samples, result.rows, result.lost)]
            cells += [result.stream[:HASH_DIGITS], result.csv[:HASH_DIGITS]]
        rows.append((finding.run, *cells, finding.verdict))
    title = (
        f"{run.rover.robot} on {run.world.terrain}, seed {run.seed}, noise {run.rover.noise}, "
        f"{run.duration:g} simulated seconds each"
    )
    return Sheet(("run", "samples", "rows", "lost", "stream", "CSV", "verdict"), tuple(rows), title)


def proven(run: Run, findings: Sequence[Finding]) -> str:
    """Returns what runs that all passed have proven, in one line."""
    done = [finding for finding in findings if finding.result is not None]
    *_, other = done
    equal = ", ".join(finding.run for finding in done[:-1])
    total = sum(finding.result.samples for finding in done if finding.result is not None)
    left_out = "" if len(done) == len(findings) else ", not through ROS 2"
    return (
        f"proven for {run.rover.robot} on {run.world.terrain}{left_out}: seed {run.seed} gives the same "
        f"samples and the same CSV bytes in {len(done) - 1} runs ({equal}), {other.run} gives others, "
        f"and none of {total:,} samples was lost"
    )


def _exit_code(findings: Sequence[Finding], *, ros_was_asked_for: bool) -> int:
    failed = [finding for finding in findings if not finding.passed]
    if failed:
        message = "; ".join(f"{finding.run}: {finding.verdict}" for finding in failed)
        complain("harness.check", message)
        return 1
    if ros_was_asked_for and any(finding.result is None for finding in findings):
        message = f"the run through ROS was not checked; {INSTALL_ROS}, or leave it out with --no-ros"
        complain("harness.check", message)
        return UsageError.exit_code
    return 0


def _run(options: argparse.Namespace) -> Run:
    """The run to repeat, with noise so that every random generator takes part; or UsageError."""
    from harness.episode.assembly import check

    given = {name: getattr(options, name) for name in ("terrain", "robot", "seed", "duration")}
    run = Run.of(noise=DEFAULT_NOISE, **given)
    check(run)
    if run.duration < SHORTEST_DURATION:
        message = f"duration {run.duration:g} s is too short; give {SHORTEST_DURATION:g} s or more"
        raise UsageError(message)
    return run


def _parser() -> argparse.ArgumentParser:
    defaults = Run()
    parser = OneLineParser(
        prog="python -m harness.check",
        description="Proves on this machine that equal seeds give equal bytes, through ROS or not, "
        "and that no message is lost.",
        epilog="Exit code 0: proven. 1: disproven, or a run failed. 2: a wrong argument, or ROS is "
        "missing and --no-ros was not given.",
    )
    terrain, about = defaults.world.terrain, "see harness.run"
    parser.add_argument("--terrain", default=terrain, metavar="NAME", help=about)
    about = f"{', '.join(ROVERS)}, or a folder (docs/robots.md)"
    parser.add_argument("--robot", default=defaults.rover.robot, metavar="NAME|FOLDER", help=about)
    about = "of everything random; the other seed is the next"
    parser.add_argument("--seed", type=int, default=defaults.seed, metavar="N", help=about)
    about = "simulated seconds"
    parser.add_argument("--duration", type=float, default=DEFAULT_DURATION, metavar="S", help=about)
    parser.add_argument("--no-ros", action="store_true", help="leave out the run through ROS")
    add_files(parser)
    return parser


if __name__ == "__main__":
    sys.exit(main())
