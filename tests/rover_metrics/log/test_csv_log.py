import csv
import errno
import gc
import io
import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any, BinaryIO

import pytest

from rover_metrics.core.columns import COLUMNS, Row
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.errors import LogError
from rover_metrics.log import csv_log
from rover_metrics.log.csv_log import CsvLog, harmless
from tests.rover_metrics.conftest import FullDisk

Patch = pytest.MonkeyPatch

STARTED = datetime(2025, 1, 16, 22, 4, 57)
ROW = TraversalMetrics().row(7)
LINE = b"7,0,0,0.0,0,inf,0.0,0,0,0,0,Normal operation\r\n"
HEADER = (
    b"Timestamp,Total Collisions,Current Collision Status,Smoothness Metric,Current Smoothness,"
    b"Obstacle Clearance,Distance Traveled,Current Velocity,IMU Acceleration Magnitude,"
    b"Is Rough Terrain,Vertical Roughness,Notes\r\n"
)
REAL_LOGS = Path(__file__).parents[4] / "shared/data/roboterrain/logs"


@pytest.mark.parametrize("relative", [True, False])
def test_the_folder_is_created(tmp_path: Path, monkeypatch: Patch, relative: bool) -> None:
    monkeypatch.chdir(tmp_path)
    with CsvLog("a/b" if relative else tmp_path / "a/b", STARTED) as log:
        assert log.path == tmp_path / "a/b/metrics_log_20250116_220457.csv"
        assert log.path.read_bytes() == HEADER


def test_rows_are_in_the_file_at_once_with_carriage_returns(tmp_path: Path) -> None:
    with CsvLog(tmp_path, STARTED) as log:
        for count in (1, 2, 3):
            log.write(ROW)
            assert log.path.read_bytes() == HEADER + count * LINE
            assert log.rows == count


def test_a_new_session_never_overwrites_nor_follows_a_link(tmp_path: Path) -> None:
    stem = "metrics_log_20250116_220457"
    (tmp_path / f"{stem}.csv").symlink_to(tmp_path / "elsewhere.csv")
    for number in (1, 2, 3):
        with CsvLog(tmp_path, STARTED) as log:
            log.write(ROW)
            assert log.path.name == f"{stem}_{number}.csv"
    assert (tmp_path / f"{stem}_1.csv").read_bytes() == HEADER + LINE
    assert not (tmp_path / "elsewhere.csv").exists()


def test_closing_twice_is_fine_and_writing_after_it_is_an_error(tmp_path: Path) -> None:
    log = CsvLog(tmp_path, STARTED)
    for _ in range(2):
        log.close()
    with pytest.raises(LogError, match=f"in {tmp_path}: I/O operation on closed file; choose another"):
        log.write(ROW)
    assert log.rows == 0


def test_a_folder_that_cannot_be_or_takes_no_files_is_named_with_the_mend(tmp_path: Path) -> None:
    (tmp_path / "f").write_text("mine")
    for folder, mend in (("f", "remove it"), ("f/deeper", "remove it"), ("/proc/1", "another folder")):
        with pytest.raises(LogError, match=f"in {tmp_path / folder}: .*{mend}"):
            CsvLog(tmp_path / folder, STARTED)
    assert (tmp_path / "f").read_text() == "mine"


def test_a_torn_row_is_forgotten_and_taken_again(tmp_path: Path, full_disk: FullDisk) -> None:
    other = replace(ROW, stamp_s=123456789)
    for taken in range(0, len(LINE), 5):
        with CsvLog(tmp_path / str(taken), STARTED) as log:
            log.write(ROW)
            for row in (ROW, other):
                full = full_disk(len(HEADER) + len(LINE) + taken)
                with full, pytest.raises(LogError, match=str(tmp_path)):
                    log.write(row)
                assert log.path.read_bytes() == HEADER + LINE, taken
            log.write(ROW)
            log.write(other)
            assert log.path.read_bytes() == HEADER + 2 * LINE + b"123456789" + LINE[1:], taken
            assert log.rows == 3, taken


def test_wherever_the_header_is_torn_no_file_is_left(tmp_path: Path, full_disk: FullDisk) -> None:
    for taken in range(0, len(HEADER), 7):
        with full_disk(taken), pytest.raises(LogError, match="choose another folder"):
            CsvLog(tmp_path, STARTED)
        assert list(tmp_path.iterdir()) == [], taken


@pytest.mark.skipif(not REAL_LOGS.is_dir(), reason="needs the RoboTerrain logs in ../shared/data")
def test_the_rows_of_a_real_log_come_out_as_they_went_in(tmp_path: Path) -> None:
    real = REAL_LOGS / "metrics_log_20250116_120457.csv"
    with CsvLog(tmp_path, STARTED) as log, real.open(newline="") as lines:
        for cells in list(csv.reader(lines))[1:]:
            numbers: list[Any] = [float(cell) if "." in cell else int(cell) for cell in cells[:-1]]
            log.write(Row(*numbers, notes=cells[-1]))  # type: ignore[misc]  # 11 numbers
        assert log.rows > 600
        assert log.path.read_bytes() == real.read_bytes()


def test_a_deleted_file_is_put_back_and_a_moved_one_followed(tmp_path: Path) -> None:
    with CsvLog(tmp_path / "a/logs", STARTED) as log:
        log.write(ROW)
        shutil.rmtree(tmp_path / "a")
        log.write(ROW)
        assert log.path.read_bytes() == HEADER + 2 * LINE
        log.path.unlink()
        log.path.write_text("mine")  # its name is taken
        log.write(ROW)
        assert (tmp_path / "a/logs/metrics_log_20250116_220457.csv").read_text() == "mine"
        assert log.path.name == "metrics_log_20250116_220457_1.csv"
        (tmp_path / "a").rename(tmp_path / "old")
        log.write(ROW)
        assert (tmp_path / "old/logs" / log.path.name).read_bytes() == HEADER + 4 * LINE
        assert (log.rows, (tmp_path / "a").exists()) == (4, False)


@pytest.fixture(autouse=True)
def _no_file_stays_open() -> Iterator[None]:
    before = sum(1 for _ in Path("/proc/self/fd").iterdir())
    yield
    gc.collect()
    assert sum(1 for _ in Path("/proc/self/fd").iterdir()) <= before


@pytest.mark.parametrize("taken", range(0, len(HEADER) + 2 * len(LINE), 31))
def test_a_deleted_file_is_put_back_when_the_disk_has_room(
    tmp_path: Path, monkeypatch: Patch, taken: int
) -> None:
    class Small(io.FileIO):
        def write(self, data: Any) -> int:  # noqa: ANN401 - a buffer
            if not data[: taken - self.tell()]:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return super().write(data[: taken - self.tell()])

    def create_on_full_disk(directory: Path, stem: str) -> tuple[Path, BinaryIO]:
        path, file = create(directory, stem)
        file.close()
        return path, Small(path, "r+")

    create = csv_log._create
    with CsvLog(tmp_path / "logs", STARTED) as log:
        log.write(ROW)
        shutil.rmtree(tmp_path / "logs")
        with monkeypatch.context() as patch:
            patch.setattr(csv_log, "_create", create_on_full_disk)
            with pytest.raises(LogError, match="No space left"):
                log.write(ROW)
        assert list((tmp_path / "logs").iterdir()) == []
        log.write(ROW)
        assert log.path.read_bytes() == HEADER + 2 * LINE
        assert log.rows == 2


@pytest.mark.parametrize(
    ("number", "mend"),
    [
        (errno.EROFS, "choose a folder on a writable file system"),
        (errno.ENOSPC, "free some disk space or choose another folder"),
        (errno.EACCES, "make it writable for this user or choose another folder"),
        (errno.EIO, "choose another folder"),
    ],
)
def test_each_refusal_has_its_mend(tmp_path: Path, monkeypatch: Patch, number: int, mend: str) -> None:
    def refuse(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    told = rf"^cannot (write a row|create a log) in {tmp_path}: {os.strerror(number)}; {mend}$"
    with CsvLog(tmp_path, STARTED) as log:
        with monkeypatch.context() as patch:
            patch.setattr(csv_log, "_write_all", refuse)
            with pytest.raises(LogError, match=told):
                log.write(ROW)
        log.write(ROW)
        assert log.path.read_bytes() == HEADER + LINE
    monkeypatch.setattr(csv_log, "_create", refuse)
    with pytest.raises(LogError, match=told):
        CsvLog(tmp_path, STARTED)


@pytest.fixture
def synced(monkeypatch: Patch) -> list[tuple[Path, int]]:
    """Each file with its size, and each folder, that the disk was waited for."""
    seen: list[tuple[Path, int]] = []

    def watch(descriptor: int) -> None:
        path = Path(f"/proc/self/fd/{descriptor}").readlink()
        seen.append((path, path.stat().st_size if path.is_file() else 0))

    monkeypatch.setattr(os, "fsync", watch)
    return seen


def test_fsync_waits_for_each_line_and_the_name(tmp_path: Path, synced: list[tuple[Path, int]]) -> None:
    with CsvLog(tmp_path, STARTED) as log:  # which is not the default
        log.write(ROW)
        assert (log.fsync, synced) == (False, [])
    with CsvLog(tmp_path / "logs", STARTED, fsync=True) as log:
        assert synced == [(log.path, len(HEADER)), (log.path.parent, 0)]
        for count in (1, 2):
            log.write(ROW)
            assert synced[count + 1 :] == [(log.path, len(HEADER) + count * len(LINE))]
        for fsync in (True, False):
            synced.clear()
            log.fsync = fsync
            shutil.rmtree(log.path.parent)  # the one that is put back is waited for as well
            log.write(ROW)
            put_back = [(log.path, len(HEADER) + 3 * len(LINE)), (log.path.parent, 0)]
            assert synced[1:] == (put_back if fsync else [])
        assert log.path.read_bytes() == HEADER + 4 * LINE


@pytest.mark.parametrize("confirmed", [0, 1])
def test_a_row_without_its_fsync_is_an_error(tmp_path: Path, monkeypatch: Patch, confirmed: int) -> None:
    calls: list[int] = []

    def refuse(descriptor: int) -> None:
        calls.append(descriptor)
        if len(calls) > confirmed:
            raise OSError(errno.EIO, os.strerror(errno.EIO))

    with CsvLog(tmp_path / "logs", STARTED) as log:
        log.fsync = True
        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", refuse)
            for _ in range(confirmed):
                log.write(ROW)
            with pytest.raises(LogError, match="Input/output error"):
                log.write(ROW)
            with pytest.raises(LogError, match="Input/output error"):
                CsvLog(tmp_path / "other", STARTED, fsync=True)
        assert log.path.read_bytes() == HEADER + confirmed * LINE
        assert list((tmp_path / "other").iterdir()) == []
        log.write(ROW)
        assert log.path.read_bytes() == HEADER + (1 + confirmed) * LINE


def test_no_text_starts_a_formula_and_negative_numbers_stay_numbers(tmp_path: Path) -> None:
    texts = ["=cmd|calc é", "+1.5", "@x", "\t1", "\r1", "\n1"]
    texts += ["-5", "-1.5e3", "-1.50 m", "--1.5", "-.5", "-1."]
    columns = ("=SUM(A1)", *COLUMNS[1:])
    with CsvLog(tmp_path, STARTED, columns=columns) as log:
        for text in texts:
            log.write(replace(ROW, notes=text, obstacle_clearance=-1.5))
    with log.path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header[0] == "'=SUM(A1)"
    assert [(row[-1], row[5]) for row in rows] == [(f"'{text}", "-1.5") for text in texts]
    for cell in ("-1.50", "1.50", "nan", "x-1", "", -5, -1.5):
        assert harmless(cell) == cell
