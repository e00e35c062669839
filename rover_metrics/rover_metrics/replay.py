"""Command: a recording of a rover -> the CSV that metrics_node would have written.

    python -m rover_metrics.replay BAG [-o CSV] [--params FILE]

Needs no ROS. Exit code 0: the recording is whole, stderr warns of what it lacks; 1: it was killed, cut
off or damaged, or lacks something and --require-all was given; 2: nothing could be done with these
arguments.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from functools import partial
from pathlib import Path

try:
    from rover_metrics.bag.bag_reader import Bag
    from rover_metrics.bag.mcap_stream import absolute
    from rover_metrics.bag.playback import Playback
    from rover_metrics.extended.parameter_file import read_values
    from rover_metrics.timing import TimeSource
except ImportError as error:
    print(f"replay needs two libraries: pip install rosbags mcap ({error})", file=sys.stderr)
    raise SystemExit(2) from None

from rover_metrics.errors import LogError, run_program
from rover_metrics.extended.settings import Settings
from rover_metrics.log.csv_log import CsvLog
from rover_metrics.log.files import json_safe, write_whole
from rover_metrics.parser import OneLineParser
from rover_metrics.session import MetricsSession
from rover_metrics.sheet.sheet import Sheet
from rover_metrics.topics import CLOCK, ENERGY, SENSORS, TRUTH

DEFAULT_LOG_DIR = Path(Settings().log_dir)
INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = parser().parse_args(arguments)
    try:
        return run_program("replay", lambda: _replay(options))
    except KeyboardInterrupt:
        print("replay: stopped by SIGINT", file=sys.stderr)
        return INTERRUPTED


def _replay(options: argparse.Namespace) -> int:
    parameters = Settings().updated(read_values(options.params, None) if options.params else {})
    is_extended = options.extended or parameters.extended_columns
    session = MetricsSession(parameters.thresholds, parameters.extended if is_extended else None)
    code = 0
    with Bag(options.bag) as bag:
        playback = Playback(bag, session, dict(options.remap), TimeSource(options.time))
        with _log(options.output, options.bag, session.columns, overwrite=options.overwrite) as log:
            try:
                for row in playback.rows():
                    log.write(row)
            except KeyboardInterrupt:
                bag.problems.append("stopped by SIGINT; the rows so far are kept")
                code = INTERRUPTED
    _print_summary(playback, log)
    warnings, problems = _warnings(playback), _problems(playback, bag)
    if not log.rows:
        warnings.append(f"no full second of {playback.time_source.value} time; choose another --time")
    labelled = (*(f"note: {note}" for note in playback.notes), *(f"warning: {w}" for w in warnings))
    for line in (*labelled, *problems):
        print(f"replay: {line}", file=sys.stderr)
    _write_files(options, playback, log, [*playback.notes, *warnings, *problems])
    return code or int(bool(problems or (options.require_all and warnings)))


@contextmanager
def _log(output: Path | None, bag: Path, columns: Sequence[str], *, overwrite: bool) -> Iterator[CsvLog]:
    """The log to write to; a file asked for by name gets its name when it is whole."""
    if overwrite and output is None:
        raise LogError("--overwrite is for the file of -o; name one, or leave it out")
    if output is None or output.is_dir():
        with CsvLog(output or DEFAULT_LOG_DIR, datetime.now(), columns=columns) as log:
            yield log
        return
    if output.exists() and not output.is_file():
        raise LogError(f"{output} is no file; name another")
    if output.exists() and not overwrite:
        raise LogError(f"{output} exists already, not overwriting; name another file or --overwrite it")
    if output.exists() and output.samefile(bag):
        raise LogError(f"{output} is the recording itself; name another file")
    with CsvLog(output.absolute().parent, datetime.now(), columns=columns) as log:
        try:
            yield log
        finally:
            try:
                log.path = log.path.replace(output)
            except OSError as error:
                message = f"cannot write {output}: {error.strerror}; the rows are in {log.path}"
                raise LogError(message) from error


def _print_summary(playback: Playback, log: CsvLog) -> None:
    print(f"rows follow {playback.time_source.value} time")
    for topic, count in sorted(playback.counts.items()):
        print(f"  {topic:<20} {count.used:>8,} messages")
    metrics = playback.metrics
    print(f"{metrics.total_distance:.2f} m travelled, {metrics.total_collisions} collisions")
    print(f"{log.rows} rows in {log.path}")


def _write_files(options: argparse.Namespace, playback: Playback, log: CsvLog, said: list[str]) -> None:
    """Writes the outcome for --json, and the page of the log for --page."""
    topics = {topic: vars(count) for topic, count in sorted(playback.counts.items())}
    if options.json is not None:
        metrics = playback.metrics
        place = {"log": str(log.path), "time": playback.time_source.value, "rows": log.rows}
        counts = {"distance": metrics.total_distance, "collisions": metrics.total_collisions}
        everything = json_safe({**place, **counts, "topics": topics, "said": said})
        write_whole(options.json, json.dumps(everything, indent=2))
    if options.page is not None:
        from rover_metrics.analysis.command import page_of_log  # noqa: PLC0415 - pandas takes a second

        rows = (
            {"topic": topic} | {n: f"{v:,}" for n, v in one.items()} for topic, one in topics.items()
        )
        recording = Sheet.of(rows, f"Messages of {options.bag.name}", findings=tuple(said))
        write_whole(options.page, page_of_log(log.path, [recording]))


def _warnings(playback: Playback) -> list[str]:
    """What a whole recording does not have; a line each."""
    return [f"{reason}; name another with --remap" for reason in playback.missing] + [
        f"{topic}: {count.rejected} messages are empty, not finite or impossible, left out"
        for topic, count in playback.counts.items()
        if count.rejected
    ]


def _problems(playback: Playback, bag: Bag) -> list[str]:
    """How the recording itself is damaged; a line each."""
    return bag.problems + [
        f"{topic}: {count.unreadable} messages are not readable, left out"
        for topic, count in playback.counts.items()
        if count.unreadable
    ]


def parser() -> argparse.ArgumentParser:
    """Returns the parser of the command line."""
    parser = OneLineParser(
        prog="python -m rover_metrics.replay",
        description="Computes the traversal metrics of a recorded drive, as metrics_node would have.",
        epilog="A row holds everything up to and including its full second. Recordings that were "
        "killed, cut off or damaged are read as far as they go; the exit code is then 1. A topic that a "
        "whole recording lacks is a warning.",
    )
    add, switch = parser.add_argument, partial(parser.add_argument, action="store_true")
    add("bag", type=Path, metavar="BAG", help="rosbag2 folder, .mcap or .db3 file")
    about = f"file, or folder for a metrics_log_*.csv; default: {DEFAULT_LOG_DIR}/"
    add("-o", "--csv", "--out", "--output", dest="output", type=Path, metavar="CSV", help=about)
    switch("--overwrite", help="replace the file of -o")
    about = "write a page about the log: pictures, statistics, messages of the recording"
    add("--page", type=Path, metavar="FILE.html", help=about)
    add("--json", type=Path, metavar="FILE", help="write what came of it")
    switch("--require-all", help="exit with 1 too if a topic is missing or a message was left out")
    add("--params", type=Path, metavar="FILE", help="ROS parameter file (YAML)")
    about = (
        "write the extended columns too (docs/metrics.md); so does extended_columns in --params, "
        "which may also name footprint and lidar_pose"
    )
    switch("--extended", help=about)
    about = "read topic FROM from the recorded topic TO, e.g. scan:=front/scan; repeatable"
    add("--remap", type=_remap, action="append", default=[], metavar="FROM:=TO", help=about)
    about = (
        "what rows follow: /clock (sim), when messages were recorded, their header stamps; "
        "auto is sim where the recording has /clock, else recorded"
    )
    times = [source.value for source in TimeSource]
    add("--time", choices=times, default=TimeSource.AUTO.value, help=about)
    return parser


def _remap(text: str) -> tuple[str, str]:
    """Returns the two parts of FROM:=TO, both made absolute."""
    known = [source.name for source in (*SENSORS, *TRUTH, *ENERGY, CLOCK)]
    name, separator, recorded = text.partition(":=")
    name, recorded = map(absolute, (name, recorded))
    if not separator or recorded == "/" or name not in known:
        valid = ", ".join(topic.lstrip("/") for topic in known)
        message = f"'{text}' is not valid; give FROM:=TO, where FROM is one of {valid}"
        raise argparse.ArgumentTypeError(message)
    return name, recorded


if __name__ == "__main__":
    sys.exit(main())
