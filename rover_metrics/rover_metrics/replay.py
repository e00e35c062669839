"""Command: a recording of a rover -> the CSV that metrics_node would have written.

    python -m rover_metrics.replay BAG [-o CSV] [--params FILE]

Needs no ROS. Exit code 0: everything was there; 1: the CSV is partial, stderr says why; 2: nothing
could be done with these arguments.
"""

import argparse
import difflib
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any, NoReturn

from rover_metrics.csv_log import CsvLog
from rover_metrics.errors import LogError, ParameterError, RoverMetricsError, ThresholdError
from rover_metrics.metrics import TraversalMetrics
from rover_metrics.thresholds import DEFAULT_THRESHOLDS, THRESHOLD_INFO, Thresholds

try:
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    from rover_metrics.bag_reader import Bag
    from rover_metrics.playback import CLOCK, SENSORS, Playback, TimeSource
except ImportError as error:
    sys.exit(f"replay needs two libraries: pip install rosbags mcap ({error})")

DEFAULT_LOG_DIR = Path("metrics_analyzer/data/metric_logs")
NODE_NAMES = ("metrics_node", "*", "**")
INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; gives its exit code."""
    options = _parser().parse_args(arguments)
    try:
        return _replay(options)
    except RoverMetricsError as error:
        print(f"replay: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        print("replay: stopped by SIGINT", file=sys.stderr)
        return INTERRUPTED


def _replay(options: argparse.Namespace) -> int:
    metrics = TraversalMetrics(read_thresholds(options.params) if options.params else DEFAULT_THRESHOLDS)
    code = 0
    with Bag(options.bag) as bag:
        playback = Playback(bag, metrics, dict(options.remap), TimeSource(options.time))
        with _log(options.output, options.bag, overwrite=options.overwrite) as log:
            try:
                for row in playback.rows():
                    log.write(row)
            except KeyboardInterrupt:
                bag.problems.append("stopped by SIGINT; the rows so far are kept")
                code = INTERRUPTED
    _print_summary(playback, log)
    problems = _problems(playback, bag)
    for line in (*(f"note: {note}" for note in playback.notes), *problems):
        print(f"replay: {line}", file=sys.stderr)
    return code or int(bool(problems))


@contextmanager
def _log(output: Path | None, bag: Path, *, overwrite: bool) -> Iterator[CsvLog]:
    """The log to write to; a file asked for by name gets its name when it is whole.

    Raises:
        LogError: It cannot be created, or the name is taken.
    """
    if output is None or output.is_dir():
        with CsvLog(output or DEFAULT_LOG_DIR, datetime.now()) as log:
            yield log
        return
    if output.exists() and not overwrite:
        raise LogError(f"{output} exists already, not overwriting; name another file or --overwrite it")
    if output.exists() and output.samefile(bag):
        raise LogError(f"{output} is the recording itself; name another file")
    with CsvLog(output.absolute().parent, datetime.now()) as log:
        try:
            yield log
        finally:
            _rename(log, output)


def _rename(log: CsvLog, output: Path) -> None:
    try:
        log.path = log.path.replace(output)
    except OSError as error:
        message = f"cannot write {output}: {error.strerror}; the rows are in {log.path}"
        raise LogError(message) from error


def read_thresholds(path: Path) -> Thresholds:
    """Read the thresholds of metrics_node from a ROS parameter file.

    Args:
        path: YAML as for `--ros-args --params-file`. Later sections of the node win; parameters that
            are no thresholds are left alone.

    Raises:
        ParameterError: The file is not readable, names no parameters for metrics_node, or a value
            is not valid.
    """
    try:
        document = YAML(typ="safe").load(path)
    except (OSError, UnicodeDecodeError, YAMLError) as error:
        reason = error.strerror if isinstance(error, OSError) else " ".join(str(error).split())
        raise ParameterError(f"cannot read parameters from {path}: {reason}") from error
    sections = list(_sections(document, ""))
    if not sections:
        raise ParameterError(f"{path} has no section 'metrics_node: ros__parameters:'")
    values: dict[str, float] = {}
    for section in sections:
        for name, value in section.items():
            values |= _threshold(str(name), value)
    try:
        return Thresholds(**values)
    except ThresholdError as error:
        raise ParameterError(f"{path}: {error}") from error


def _sections(node: Any, name: str) -> Iterator[dict[Any, Any]]:  # noqa: ANN401 - any YAML
    """The parameters of each section that is about metrics_node, in any namespace."""
    if not isinstance(node, dict):
        return
    for key, value in node.items():
        if key != "ros__parameters":
            yield from _sections(value, str(key).rpartition("/")[2])
        elif name in NODE_NAMES and isinstance(value, dict):
            yield value


def _threshold(name: str, value: object) -> dict[str, float]:
    """The parameter if it is a threshold, checked for its type as ROS would."""
    info = THRESHOLD_INFO.get(name)
    if info is None:
        meant = difflib.get_close_matches(name, THRESHOLD_INFO, n=1, cutoff=0.8)
        if meant:
            raise ParameterError(f"there is no parameter {name}; did you mean {meant[0]}?")
        return {}
    if not isinstance(value, float):
        raise ParameterError(
            f"parameter {name} must be a number with a decimal point (1.0, not 1) {info.valid_range}"
        )
    return {name: value}


def _print_summary(playback: Playback, log: CsvLog) -> None:
    print(f"rows follow {playback.time_source.value} time")
    for topic, count in sorted(playback.counts.items()):
        print(f"  {topic:<20} {count.used:>8,} messages")
    metrics = playback.metrics
    print(f"{metrics.total_distance:.2f} m travelled, {metrics.total_collisions} collisions")
    print(f"{log.rows} rows in {log.path}")


def _problems(playback: Playback, bag: Bag) -> list[str]:
    """Why the rows are not all that they could be; a line each."""
    problems = [f"{reason}; name another with --remap" for reason in playback.missing] + bag.problems
    for topic, count in playback.counts.items():
        if count.unreadable:
            problems.append(f"{topic}: {count.unreadable} messages are not readable, left out")
        if count.rejected:
            problems.append(
                f"{topic}: {count.rejected} messages are empty, not finite or impossible, left out"
            )
    return problems


def _remap(text: str) -> tuple[str, str]:
    """Parse FROM:=TO, both made absolute."""
    known = (*SENSORS, CLOCK)
    name, separator, recorded = text.partition(":=")
    name, recorded = (f"/{part.strip().lstrip('/')}" for part in (name, recorded))
    if not separator or recorded == "/" or name not in known:
        valid = ", ".join(topic.lstrip("/") for topic in known)
        message = f"'{text}' is not valid; give FROM:=TO, where FROM is one of {valid}"
        raise argparse.ArgumentTypeError(message)
    return name, recorded


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line, as all others of this command."""

    def error(self, message: str) -> NoReturn:
        """Print the message and leave with exit code 2."""
        self.exit(2, f"replay: {message}; see --help\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="python -m rover_metrics.replay",
        description="Computes the traversal metrics of a recorded drive, as metrics_node would have.",
        epilog="A row holds everything up to and including its full second. Recordings that were "
        "killed, cut off or damaged are read as far as they go; the exit code is then 1.",
    )
    parser.add_argument("bag", type=Path, metavar="BAG", help="rosbag2 folder, .mcap or .db3 file")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="CSV",
        help=f"file, or folder for a metrics_log_*.csv; default: {DEFAULT_LOG_DIR}/",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace the file of -o")
    parser.add_argument("--params", type=Path, metavar="FILE", help="ROS parameter file (YAML)")
    parser.add_argument(
        "--remap",
        type=_remap,
        action="append",
        default=[],
        metavar="FROM:=TO",
        help="read topic FROM from the recorded topic TO, e.g. scan:=front/scan; repeatable",
    )
    parser.add_argument(
        "--time",
        choices=[source.value for source in TimeSource],
        default=TimeSource.AUTO.value,
        help="what rows follow: /clock (sim), when messages were recorded, their header stamps; "
        "auto is sim where the recording has /clock, else recorded",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
