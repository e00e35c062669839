"""What is left of a log after a full disk, a power cut or a kill is read as far as it is whole."""

import os
import signal
import subprocess
import sys
from datetime import datetime
from pathlib import Path

import pytest

import rover_metrics
from rover_metrics.analysis.logs.reading import read_log
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.log.csv_log import CsvLog

STARTED = datetime(2025, 1, 16)
PACKAGE = str(Path(rover_metrics.__file__).parents[1])


@pytest.fixture
def log(tmp_path: Path) -> Path:
    metrics = TraversalMetrics()
    metrics.add_scan([1.0])
    with CsvLog(tmp_path, STARTED) as written:
        for second in (7, 8, 9):
            written.write(metrics.row(second))
    return written.path


def test_wherever_the_last_line_is_torn_only_rows_with_all_their_numbers_are_read(log: Path) -> None:
    data = log.read_bytes()
    start, notes = data[:-2].rindex(b"\n") + 1, data.rindex(b",") + 1
    for end in range(start + 1, len(data)):
        log.write_bytes(data[:end])
        read = read_log(log)
        if end < notes:
            assert read.stamps.tolist() == [7, 8]
            assert read.findings == ("1 row with fewer fields than the header (line 4): left out",)
        else:
            assert read.stamps.tolist() == [7, 8, 9]
            assert read.findings == ()


def test_zeros_that_a_power_cut_leaves_are_no_row(log: Path) -> None:
    log.write_bytes(log.read_bytes() + bytes(4096))
    read = read_log(log)
    assert read.stamps.tolist() == [7, 8, 9]
    assert read.findings == ("1 row with fewer fields than the header (line 5): left out",)


def test_lines_of_another_length_are_skipped_with_their_numbers(log: Path) -> None:
    lines = log.read_bytes().splitlines(keepends=True)
    lines[2] = b"8,0,0\r\n"
    log.write_bytes(b"".join(lines))
    read = read_log(log)
    assert read.stamps.tolist() == [7, 9]
    assert "1 row with fewer fields than the header (line 3): left out" in read.findings


def test_a_writer_killed_in_mid_write_leaves_a_log_that_can_be_read(tmp_path: Path) -> None:
    child = (
        "import datetime, sys\n"
        "from rover_metrics.log.csv_log import CsvLog\n"
        "from rover_metrics.core.metrics import TraversalMetrics\n"
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
    stamps = read_log(path).stamps.tolist()
    assert len(stamps) > 200
    assert stamps == list(range(len(stamps)))
