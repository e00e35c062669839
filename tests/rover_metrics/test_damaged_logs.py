"""What is left of a log after a full disk, a power cut or a kill is read as far as it is whole."""

import gzip
import json
from datetime import datetime
from itertools import permutations
from pathlib import Path

import pytest

from rover_metrics import analyze, social
from rover_metrics.analysis.logs.reading import read_log
from rover_metrics.analysis.study import labels
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.log.csv_log import CsvLog

STARTED = datetime(2025, 1, 16)


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
    for end in {*range(start + 1, len(data), 4), notes - 1, notes, notes + 1, len(data) - 1}:
        log.write_bytes(data[:end])
        read = read_log(log)
        lost = ("1 row with fewer fields than the header (line 4): left out",) if end < notes else ()
        assert (read.stamps.tolist(), read.findings) == ([7, 8] if lost else [7, 8, 9], lost)


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


def test_a_bad_log_harms_no_other(log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wide, missing, packed = (tmp_path / f"{name}.csv" for name in ("wide", "missing", "packed"))
    packed.write_bytes(gzip.compress(log.read_bytes()))
    wide.write_bytes(log.read_text().encode("utf-16"))
    for bad, reason, code in (
        (wide, "it is no text in UTF-8, perhaps UTF-16; save it as CSV in UTF-8", 1),
        (packed, "it is packed by gzip; unpack it first", 1),
        (Path("/proc/self/mem"), "cannot be read: Input/output error", 1),
        (missing, "there is no such file", 2),
    ):
        assert analyze.main([str(bad), str(log), "-m", "CV", "-p", "--json"]) == code
        out, told = capsys.readouterr()
        assert (told, len(json.loads(out)["logs"])) == (f"analyze: skipped {bad}: {reason}\n", 1)
        assert (analyze.main([str(bad)]), social.main([str(bad)])) == (code, code)
        assert f"social: skipped {bad}: {reason}\n" in capsys.readouterr().err
    for order in permutations(map(str, (wide, missing, log))):
        assert analyze.main([*order, "-m", "CV", "-p", "--json"]) == 2


@pytest.mark.parametrize(
    "record",
    [
        "[" * 5000 + "]" * 5000,
        '{"outcome": {}, "thresholds": {"collision_threshold": %s}}' % ("9" * 400),
        '{"arguments": {"robot": "leo", "terrain": ["x"], "seed": 1, "difficulty": %s}}' % ("9" * 5001),
    ],
)
def test_a_records_oddities_leave_its_log_alone(log: Path, record: str) -> None:
    log.with_suffix(".json").write_text(record)
    read = read_log(log)
    assert (read.stamps.tolist(), read.thresholds) == ([7, 8, 9], None)
    assert labels([read]) == [log.stem]
