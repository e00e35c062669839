"""What is left of a log after a full disk, a power cut or a kill is read as far as it is whole."""

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
