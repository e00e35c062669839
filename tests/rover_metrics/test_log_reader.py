import os
import signal
import subprocess
import sys
from datetime import datetime
from pathlib import Path

import pytest

import rover_metrics
from rover_metrics.csv_log import CsvLog
from rover_metrics.errors import LogError
from rover_metrics.log_reader import read_rows
from rover_metrics.metrics import TraversalMetrics
from rover_metrics.row import COLUMNS
from rover_metrics.session_record import COMPLETE, write_record

STARTED = datetime(2025, 1, 16)
PACKAGE = str(Path(rover_metrics.__file__).parents[1])
REAL_LOGS = Path(__file__).parents[3] / "shared/data/roboterrain/logs"


@pytest.fixture
def log(tmp_path: Path) -> Path:
    with CsvLog(tmp_path, STARTED) as written:
        for second in (7, 8, 9):
            written.write(TraversalMetrics().row(second))
    return written.path


def test_a_whole_log_is_read_without_findings(log: Path) -> None:
    read = read_rows(log)
    assert read.columns == COLUMNS
    assert [row[0] for row in read.rows] == ["7", "8", "9"]
    assert read.rows[0][-1] == "Normal operation"
    assert read.findings == ()


def test_wherever_the_last_line_is_torn_only_whole_rows_are_read(log: Path) -> None:
    data = log.read_bytes()
    start = data[:-2].rindex(b"\n") + 1
    for end in range(start + 1, len(data)):
        log.write_bytes(data[:end])
        read = read_rows(log)
        assert [row[0] for row in read.rows] == ["7", "8"]
        assert len(read.findings) == 1
        assert "line 4 is torn" in read.findings[0]
        assert "skipped" in read.findings[0]


def test_zeros_that_a_power_cut_leaves_are_no_row(log: Path) -> None:
    log.write_bytes(log.read_bytes() + bytes(4096))
    read = read_rows(log)
    assert len(read.rows) == 3
    assert "line 5 is torn" in read.findings[0]


def test_lines_of_another_length_are_skipped_with_their_numbers(log: Path) -> None:
    lines = log.read_bytes().splitlines(keepends=True)
    lines[2] = b"8,0,0\r\n"
    log.write_bytes(b"".join(lines))
    read = read_rows(log)
    assert [row[0] for row in read.rows] == ["7", "9"]
    assert read.findings == ("line 3 has 3 cells instead of 12; skipped",)


def test_a_log_without_rows_is_empty_but_one_without_header_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(b"Timestamp,Notes\r\n")
    assert read_rows(path).rows == ()
    for data in (b"", b"Timestamp,Total Coll"):
        path.write_bytes(data)
        with pytest.raises(LogError, match="has no header"):
            read_rows(path)
    with pytest.raises(LogError, match="No such file"):
        read_rows(tmp_path / "missing.csv")


def test_a_session_that_was_killed_is_read_with_a_finding_and_one_that_ended_without(
    log: Path,
) -> None:
    write_record(log, None, {})
    assert read_rows(log).findings == (
        "the session has no end mark: it was killed, or is still running",
    )
    write_record(log, COMPLETE, {})
    assert read_rows(log).findings == ()


@pytest.mark.skipif(not REAL_LOGS.is_dir(), reason="needs the RoboTerrain logs in ../shared/data")
def test_the_real_logs_are_read_whole() -> None:
    for path in REAL_LOGS.glob("*.csv"):
        read = read_rows(path)
        assert len(read.rows) == len(path.read_bytes().splitlines()) - 1
        assert read.findings == ()


def test_a_writer_killed_in_mid_write_leaves_a_log_that_can_be_read(tmp_path: Path) -> None:
    child = (
        "import datetime, sys\n"
        "from rover_metrics.csv_log import CsvLog\n"
        "from rover_metrics.metrics import TraversalMetrics\n"
        "log = CsvLog('.', datetime.datetime(2025, 1, 16))\n"
        "for second in range(10**9):\n"
        "    log.write(TraversalMetrics().row(second))\n"
        "    if second == 200: print('there', flush=True)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", child],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": PACKAGE},
        stdout=subprocess.PIPE,
    ) as writer:
        assert writer.stdout is not None
        writer.stdout.readline()
        writer.send_signal(signal.SIGKILL)
    assert writer.returncode == -signal.SIGKILL
    (path,) = tmp_path.glob("*.csv")
    stamps = [int(row[0]) for row in read_rows(path).rows]
    assert len(stamps) > 200
    assert stamps == list(range(len(stamps)))
