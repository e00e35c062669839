import csv
import errno
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any, BinaryIO

import pytest

import rover_metrics
from rover_metrics import csv_log
from rover_metrics.csv_log import CsvLog
from rover_metrics.errors import LogError
from rover_metrics.metrics import TraversalMetrics
from rover_metrics.row import COLUMNS, MetricsRow

STARTED = datetime(2025, 1, 16, 12, 4, 57)
ROW = TraversalMetrics().row(7)
LINE = b"7,0,0,0.0,0,inf,0.0,0,0,0,0,Normal operation\r\n"
HEADER = (
    b"Timestamp,Total Collisions,Current Collision Status,Smoothness Metric,Current Smoothness,"
    b"Obstacle Clearance,Distance Traveled,Current Velocity,IMU Acceleration Magnitude,"
    b"Is Rough Terrain,Vertical Roughness,Notes\r\n"
)
FullDisk = Callable[[int], AbstractContextManager[None]]
REAL_LOGS = Path(__file__).parents[3] / "shared/data/roboterrain/logs"


def test_the_folder_is_created_and_the_name_tells_the_start(tmp_path: Path) -> None:
    with CsvLog(tmp_path / "a/b", STARTED) as log:
        assert log.path == tmp_path / "a/b/metrics_log_20250116_120457.csv"
        assert log.path.read_bytes() == HEADER


def test_a_relative_folder_gives_an_absolute_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with CsvLog("logs", STARTED) as log:
        assert log.path == tmp_path / "logs/metrics_log_20250116_120457.csv"


def test_rows_are_in_the_file_at_once_with_carriage_returns(tmp_path: Path) -> None:
    with CsvLog(tmp_path, STARTED) as log:
        for count in (1, 2, 3):
            log.write(ROW)
            assert log.path.read_bytes() == HEADER + count * LINE
            assert log.rows == count


def test_a_new_session_never_overwrites(tmp_path: Path) -> None:
    paths = []
    for _ in range(3):
        with CsvLog(tmp_path, STARTED) as log:
            log.write(ROW)
            paths.append(log.path.name)
    stem = "metrics_log_20250116_120457"
    assert paths == [f"{stem}.csv", f"{stem}_1.csv", f"{stem}_2.csv"]
    assert all((tmp_path / path).read_bytes() == HEADER + LINE for path in paths)


def test_a_dangling_link_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "metrics_log_20250116_120457.csv").symlink_to(tmp_path / "elsewhere.csv")
    with CsvLog(tmp_path, STARTED) as log:
        assert log.path.name == "metrics_log_20250116_120457_1.csv"


def test_rows_survive_the_death_of_the_process(tmp_path: Path) -> None:
    child = (
        "import datetime, os, signal\n"
        "from rover_metrics.csv_log import CsvLog\n"
        "from rover_metrics.metrics import TraversalMetrics\n"
        "log = CsvLog('.', datetime.datetime(2025, 1, 16))\n"
        "for _ in range(50): log.write(TraversalMetrics().row(7))\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    package = str(Path(rover_metrics.__file__).parents[1])
    died = subprocess.run(
        [sys.executable, "-c", child],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": package},
        check=False,
    )
    assert died.returncode == -signal.SIGKILL
    assert (tmp_path / "metrics_log_20250116_000000.csv").read_bytes() == HEADER + 50 * LINE


def test_closing_twice_is_fine_and_writing_after_it_is_an_error(tmp_path: Path) -> None:
    log = CsvLog(tmp_path, STARTED)
    log.close()
    log.close()
    with pytest.raises(LogError, match="closed"):
        log.write(ROW)
    assert log.rows == 0


@pytest.mark.parametrize("below", ["", "deeper"])
def test_a_file_in_place_of_the_folder_is_named_with_the_mend(tmp_path: Path, below: str) -> None:
    folder = tmp_path / "logs"
    folder.write_text("mine")
    with pytest.raises(LogError) as caught:
        CsvLog(folder / below, STARTED)
    message = str(caught.value)
    assert str(folder) in message
    assert "remove it or choose another folder" in message
    assert "\n" not in message
    assert folder.read_text() == "mine"


def test_a_folder_that_takes_no_files_is_named_with_the_mend() -> None:
    with pytest.raises(LogError, match=r"/proc/1: .*choose another folder"):
        CsvLog("/proc/1", STARTED)


def test_a_disk_too_full_for_the_header_leaves_no_file_behind(
    tmp_path: Path, full_disk: FullDisk
) -> None:
    with full_disk(10), pytest.raises(LogError, match="choose another folder"):
        CsvLog(tmp_path, STARTED)
    assert list(tmp_path.iterdir()) == []


def test_a_row_that_was_cut_short_leaves_no_trace_and_the_next_one_is_whole(
    tmp_path: Path, full_disk: FullDisk
) -> None:
    with CsvLog(tmp_path, STARTED) as log:
        log.write(ROW)
        for _ in range(2):
            limit = len(HEADER) + len(LINE) + 5
            with full_disk(limit), pytest.raises(LogError, match=str(tmp_path)):
                log.write(TraversalMetrics().row(123456789))
        assert log.path.read_bytes() == HEADER + LINE
        log.write(ROW)
        assert log.path.read_bytes() == HEADER + 2 * LINE
        assert log.rows == 2


@pytest.mark.skipif(not REAL_LOGS.is_dir(), reason="needs the RoboTerrain logs in ../shared/data")
@pytest.mark.parametrize("name", ["metrics_log_20250116_120457.csv", "1.csv"])
def test_the_header_is_that_of_the_real_logs_of_2025(tmp_path: Path, name: str) -> None:
    with CsvLog(tmp_path, STARTED) as log:
        real = (REAL_LOGS / name).read_bytes().splitlines(keepends=True)[0]
        assert log.path.read_bytes() == real


def _parsed(cells: list[str]) -> MetricsRow:
    """Read a row of a real log: a number with a point is a float, any other an integer."""
    numbers: list[Any] = [float(cell) if "." in cell else int(cell) for cell in cells[:-1]]
    return MetricsRow(*numbers, notes=cells[-1])  # type: ignore[misc]  # 11 numbers


@pytest.mark.skipif(not REAL_LOGS.is_dir(), reason="needs the RoboTerrain logs in ../shared/data")
def test_the_rows_of_a_real_log_come_out_as_they_went_in(tmp_path: Path) -> None:
    real = REAL_LOGS / "metrics_log_20250116_120457.csv"
    with CsvLog(tmp_path, STARTED) as log, real.open(newline="") as lines:
        for cells in list(csv.reader(lines))[1:]:
            log.write(_parsed(cells))
        assert log.rows > 600
        assert log.path.read_bytes() == real.read_bytes()


# Harm to the file while it is written


def test_a_deleted_folder_is_put_back_with_every_row(tmp_path: Path) -> None:
    with CsvLog(tmp_path / "a/logs", STARTED) as log:
        log.write(ROW)
        shutil.rmtree(tmp_path / "a")
        log.write(ROW)
        assert log.path.read_bytes() == HEADER + 2 * LINE
        log.write(ROW)
        assert log.path.read_bytes() == HEADER + 3 * LINE
        assert log.rows == 3


def test_a_deleted_file_whose_name_is_taken_is_put_back_beside_it(tmp_path: Path) -> None:
    with CsvLog(tmp_path, STARTED) as log:
        log.write(ROW)
        log.path.unlink()
        log.path.write_text("mine")
        log.write(ROW)
        assert (tmp_path / "metrics_log_20250116_120457.csv").read_text() == "mine"
        assert log.path.name == "metrics_log_20250116_120457_1.csv"
        assert log.path.read_bytes() == HEADER + 2 * LINE


def test_a_moved_file_takes_its_rows_along(tmp_path: Path) -> None:
    with CsvLog(tmp_path / "logs", STARTED) as log:
        (tmp_path / "logs").rename(tmp_path / "old")
        log.write(ROW)
        assert (tmp_path / "old" / log.path.name).read_bytes() == HEADER + LINE
        assert not (tmp_path / "logs").exists()


def test_a_deleted_file_that_a_full_disk_takes_no_copy_of_is_put_back_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    create = csv_log._create

    def create_on_full_disk(directory: Path, stem: str) -> tuple[Path, BinaryIO]:
        path, file = create(directory, stem)
        file.close()
        return path, Path("/dev/full").open("r+b", buffering=0)

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


def test_a_read_only_file_system_is_named_with_the_mend(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: object, __: bytes) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    with CsvLog(tmp_path, STARTED) as log:
        with monkeypatch.context() as patch:
            patch.setattr(csv_log, "_write_all", refuse)
            with pytest.raises(LogError, match=r"Read-only file system; choose a folder on a writable"):
                log.write(ROW)
        log.write(ROW)
        assert log.path.read_bytes() == HEADER + LINE


# Power


@pytest.mark.parametrize("fsync", [False, True])
def test_with_fsync_each_line_and_the_files_name_are_on_the_disk_before_the_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fsync: bool
) -> None:
    synced: list[tuple[str, int]] = []

    def watch(descriptor: int) -> None:
        path = Path(f"/proc/self/fd/{descriptor}").readlink()
        synced.append((path.name, path.stat().st_size if path.is_file() else 0))

    monkeypatch.setattr(os, "fsync", watch)
    with CsvLog(tmp_path, STARTED, fsync=fsync) as log:
        log.write(ROW)
        log.write(ROW)
    name = log.path.name
    sizes = [len(HEADER) + count * len(LINE) for count in range(3)]
    expected = [(name, sizes[0]), (tmp_path.name, 0), (name, sizes[1]), (name, sizes[2])]
    assert synced == (expected if fsync else [])


def test_a_row_that_the_disk_does_not_confirm_is_an_error_and_not_in_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: int) -> None:
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    with CsvLog(tmp_path, STARTED) as log:
        log.fsync = True
        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", refuse)
            with pytest.raises(LogError, match="Input/output error"):
                log.write(ROW)
        assert log.path.read_bytes() == HEADER
        log.write(ROW)
        assert log.path.read_bytes() == HEADER + LINE


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "\t", "\r", "\n"])
def test_no_text_cell_starts_a_formula_and_negative_numbers_stay_numbers(
    tmp_path: Path, start: str
) -> None:
    row = replace(TraversalMetrics().row(1), notes=f"{start}cmd|calc", obstacle_clearance=-1.5)
    with CsvLog(tmp_path, STARTED, columns=(f"{start}SUM(A1)", *COLUMNS[1:])) as log:
        log.write(row)
    with log.path.open(newline="") as file:
        header, cells = csv.reader(file)
    assert header[0] == f"'{start}SUM(A1)"
    assert cells[-1] == f"'{start}cmd|calc"
    assert cells[5] == "-1.5"
