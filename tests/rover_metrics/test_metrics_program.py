"""The program metrics_node: how it ends and what it says when it cannot start."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import rover_metrics
from rover_metrics.analysis.logs.reading import read_log
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.log.session_record import SessionEnd, session_end, session_thresholds
from tests.support.waiting import PATIENCE, wait_until

pytestmark = pytest.mark.usefixtures("ros_domain")

UNMARKED = "the session has no end mark: it was killed, or is still running"
PACKAGE = str(Path(rover_metrics.__file__).parents[1])
COMMAND = [sys.executable, "-m", "rover_metrics.metrics_node"]


def environment(*paths: str) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": os.pathsep.join([*paths, PACKAGE])}


@pytest.fixture
def _ros() -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")


@contextmanager
def running(tmp_path: Path, *args: str) -> Iterator[tuple["subprocess.Popen[str]", Path]]:
    """The program with its log, once it has written a row; killed afterwards if it still runs."""
    with subprocess.Popen(
        [*COMMAND, *args], cwd=tmp_path, env=environment(), stderr=subprocess.PIPE, text=True
    ) as program:
        try:
            assert program.stderr is not None
            assert "logging to:" in program.stderr.readline()
            (log,) = (tmp_path / "metrics_analyzer/data/metric_logs").glob("metrics_log_*.csv")
            # Until the program spins: a signal before that may disturb its first message.
            wait_until(lambda: len(log.read_bytes().splitlines()) > 1)
            yield program, log
        finally:
            program.kill()


@pytest.mark.usefixtures("_ros")
def test_a_signal_ends_the_program_cleanly_and_marks_the_end(tmp_path: Path) -> None:
    with running(tmp_path) as (program, log):
        assert session_end(log) is SessionEnd.UNMARKED
        program.send_signal(signal.SIGTERM)
        _, rest = program.communicate(timeout=PATIENCE)
    assert program.returncode == 0
    assert rest == ""
    assert log.read_bytes().endswith(b",Normal operation\r\n")
    assert session_end(log) is SessionEnd.MARKED
    assert session_thresholds(log) == Thresholds()
    assert UNMARKED not in read_log(log).findings


@pytest.mark.usefixtures("_ros")
def test_a_killed_program_leaves_its_rows_and_no_end_mark(tmp_path: Path) -> None:
    with running(tmp_path) as (program, log):
        program.kill()
        program.communicate(timeout=PATIENCE)
    assert len(read_log(log)) >= 1
    assert UNMARKED in read_log(log).findings


@pytest.mark.usefixtures("_ros")
def test_an_exception_in_a_callback_is_in_the_record_and_on_the_terminal(tmp_path: Path) -> None:
    broken = (
        "import sys; from rover_metrics.metrics_node import MetricsNode, main\n"
        "MetricsNode.periodic_logging = lambda _: int('boo')\nsys.exit(main())"
    )
    words = ["-c", broken, "--ros-args", "-p", f"log_dir:={tmp_path}"]
    run = finished(tmp_path, environment(), *words)
    assert run.returncode == 1
    assert "ValueError: invalid literal" in run.stderr
    (record,) = tmp_path.glob("*.json")
    outcome = json.loads(record.read_text())["outcome"]
    assert (outcome["status"], outcome["reason"][:19]) == ("failed", "ValueError: invalid")


MISTAKES = {
    "-p debug_mode:=1": "parameter debug_mode must be true or false, not 0 or 1",
    "-p collision_threshold:=1": "(1.0, not 1) from 0.0 to 100.0 m",
    "-p colision_threshold:=1.0": "no parameter colision_threshold; did you mean collision_threshold?",
    "-p collision_threshold:=[]": "parameter collision_threshold must be a number",
    "-p use_sim_time:=[]": "use_sim_time; give true or false",
    "-p debug_interval:=0": "an integer from 1 to",
    "-p log_dir:=/dev/null": "/dev/null: File exists; a file stands where a folder should be",
    "-p use_sim_time:=maybe": "expecting type 'BOOL': use_sim_time; give true or false",
    f"-r __ns:=/{'a' * 300}": "invalid node namespace",
    f"-r scan:=/{'a' * 300}": "give another name",
    "-- bogus": "unrecognized arguments: bogus; see --help",
    "--parms-file x": "--ros-args knows no '--parms-file'; did you mean --params-file?",
    "-p debug_mode": "Couldn't parse parameter override rule",
}
ONE_AFTER_THE_OTHER = """
import sys
from rover_metrics.metrics_node import main
for words in sys.argv[1:]:
    sys.argv[1:] = ["--ros-args", *words.split()]
    try:
        print(f"<{main()}>", file=sys.stderr)
    except SystemExit as end:
        print(f"<{end.code}>", file=sys.stderr)
"""


@pytest.mark.usefixtures("_ros")
def test_a_known_mistake_is_told_in_one_line(tmp_path: Path) -> None:
    run = finished(tmp_path, environment(), "-c", ONE_AFTER_THE_OTHER, *MISTAKES)
    *answers, after_the_last = run.stderr.split("<2>\n")
    assert (after_the_last, run.returncode) == ("", 0)
    for told, answer in zip(MISTAKES.values(), answers, strict=True):
        assert "Traceback" not in answer
        line = answer.splitlines()[-1]  # rcl may have said something before
        assert line.startswith("metrics_node: ")
        assert told in line


def finished(
    folder: Path, environment: dict[str, str], *words: str
) -> "subprocess.CompletedProcess[str]":
    """Python with these words, at its end."""
    return subprocess.run(
        [sys.executable, *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )


def without_ros(tmp_path: Path, *words: str) -> "subprocess.CompletedProcess[str]":
    (tmp_path / "rclpy.py").write_text("raise ImportError(\"No module named 'rclpy'\")\n")
    return finished(tmp_path, environment(str(tmp_path)), *words)


@pytest.mark.parametrize("module", ["rover_metrics.metrics_node", "rover_metrics"])  # the script's
def test_without_ros_the_program_says_how_to_get_it(tmp_path: Path, module: str) -> None:
    run = without_ros(tmp_path, "-m", module)
    assert run.returncode == 2
    (line,) = run.stderr.splitlines()
    for told in ("No module named 'rclpy'", "rover-harness[ros]", "source /opt/ros"):
        assert told in line


def test_without_ros_a_library_user_gets_an_import_error_to_catch(tmp_path: Path) -> None:
    caller = "try: import rover_metrics.metrics_node\nexcept ImportError as e: print(e.exit_code, e)"
    assert without_ros(tmp_path, "-c", caller).stdout.startswith("2 metrics_node needs ROS 2")


@pytest.mark.parametrize("module", ["rover_metrics.metrics_node", "rover_metrics"])
def test_help_tells_the_usage_and_starts_no_node(tmp_path: Path, module: str) -> None:
    run = finished(tmp_path, environment(), "-m", module, "--help")
    assert (run.returncode, run.stderr) == (0, "")
    assert run.stdout.startswith("usage: metrics_node [-h] [--ros-args")
    assert list(tmp_path.iterdir()) == []
