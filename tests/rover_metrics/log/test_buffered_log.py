import csv
import errno
import io
import os
import shutil
from pathlib import Path

import pytest

from rover_metrics.core.columns import Row
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.errors import LogError
from rover_metrics.log.buffered_log import BufferedLog
from tests.rover_metrics.conftest import STARTED, FullDisk


def row(second: int) -> Row:
    return TraversalMetrics().row(second)


def seconds(path: Path) -> list[int]:
    with path.open(newline="") as file:
        return [int(line["Timestamp"]) for line in csv.DictReader(file)]


def buffered(folder: Path, told: list[str], *capacity: int) -> BufferedLog:
    return BufferedLog(folder, STARTED, told.append, *capacity)


def test_rows_wait_in_order_while_the_disk_is_full(tmp_path: Path, full_disk: FullDisk) -> None:
    told: list[str] = []
    log = buffered(tmp_path, told)
    assert not log.fsync
    log.write(row(0))
    with full_disk(log.path.stat().st_size + 5):
        for second in range(1, 51):
            log.write(row(second))
            assert (log.rows, log.waiting) == (1, second)
        assert seconds(log.path) == [0]
    log.write(row(51))
    assert seconds(log.path) == list(range(52))
    assert (log.rows, log.waiting, log.dropped) == (52, 0, 0)
    log.close()
    begin, end = told
    assert begin.startswith(f"cannot write a row in {tmp_path}: File too large")
    assert begin.endswith(". Up to 3600 rows wait in memory until it is mended")  # an hour
    assert end == f"writing to {log.path} again: 51 rows caught up, 0 lost"
    with BufferedLog(tmp_path, STARTED, print, fsync=True, columns=("a", "b")) as other:
        assert (other.fsync, other.path.read_bytes()) == (True, b"a,b\r\n")


def test_above_the_bound_the_oldest_rows_go_and_are_counted(tmp_path: Path, full_disk: FullDisk) -> None:
    told: list[str] = []
    log = buffered(tmp_path, told, 10)
    with full_disk(1):
        for second in range(25):
            log.write(row(second))
            assert log.waiting <= 10
    assert log.dropped == 15
    lost = [f"{rows} rows are lost so far" for rows in (1, 2, 4, 8)]
    assert [line.split(":")[0] for line in told[1:]] == lost
    log.write(row(25))
    log.close()
    assert seconds(log.path) == list(range(15, 26))
    assert told[-1].endswith("11 rows caught up, 15 lost")


def test_rows_that_wait_at_the_end_are_tried_once_more(tmp_path: Path, full_disk: FullDisk) -> None:
    told: list[str] = []
    log = buffered(tmp_path, told)
    with full_disk(1):
        for second in range(3):
            log.write(row(second))
        log.close()
        log.close()
    assert (log.rows, log.waiting, log.dropped) == (0, 0, 3)
    assert told[-1].startswith("3 rows are lost so far: cannot write a row in")
    with pytest.raises(LogError, match="closed"):
        log.write(row(3))


def test_rows_outlive_a_folder_that_cannot_be_made_again(tmp_path: Path, full_disk: FullDisk) -> None:
    told, folder = list[str](), tmp_path / "logs"
    log = buffered(folder, told)
    log.write(row(0))
    with full_disk(1):
        log.write(row(1))
    shutil.rmtree(folder)
    folder.write_text("in the way")
    for second in (2, 3):
        log.write(row(second))
    assert (log.rows, log.waiting) == (1, 3)
    assert folder.read_text() == "in the way"
    folder.unlink()
    log.write(row(4))
    assert seconds(log.path) == [0, 1, 2, 3, 4]
    assert [line.partition("; ")[2][:15] for line in told] == ["choose another ", "a file stands w", ""]
    log.close()


def test_a_file_that_the_disk_refuses_to_close_is_told(tmp_path: Path) -> None:
    class Broken(io.FileIO):
        def close(self) -> None:
            super().close()
            raise OSError(errno.EIO, os.strerror(errno.EIO))

    told: list[str] = []
    log = buffered(tmp_path, told)
    log._file.close()
    log._file = Broken(log.path, "r+")
    log.close()
    assert told == [f"cannot finish a log in {tmp_path}: Input/output error; choose another folder"]
