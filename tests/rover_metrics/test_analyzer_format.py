"""Our logs hold to what RoboTerrain's own metrics_analyzer needs of a CSV file.

It reads with plain pandas.read_csv, takes the file stem for the name, and needs a numeric Timestamp,
Current Smoothness and each chosen column. Preambles break it, a header without rows breaks it, and a row
with a field more than the header shifts every column without a word.
"""

from datetime import datetime
from pathlib import Path

import pandas as pd
import pytest
from pandas.api.types import is_numeric_dtype

from rover_metrics.core.columns import COLUMNS, Row
from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.extended.metrics import EXTENDED_HEADER, ExtendedMetrics
from rover_metrics.extended.settings import DEFAULT_EXTENDED
from rover_metrics.log.csv_log import CsvLog

# What it reads for its codes, and the smoothness that it always wants.
ANALYZER_COLUMNS = (
    *("Total Collisions", "Current Collision Status", "Smoothness Metric", "Obstacle Clearance"),
    *("Distance Traveled", "Current Velocity", "IMU Acceleration Magnitude", "Is Rough Terrain"),
    *("Vertical Roughness", "Timestamp", "Current Smoothness"),
)


@pytest.fixture(params=["twelve", "extended"])
def log(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A log of one row before any sensor spoke, and nine of a drive; without and with more columns."""
    metrics = TraversalMetrics()
    extended = ExtendedMetrics(metrics, DEFAULT_EXTENDED) if request.param == "extended" else None

    def row(second: int) -> Row:
        return metrics.row(second) if extended is None else extended.row(second * 10**9, {})

    columns = COLUMNS if extended is None else EXTENDED_HEADER
    with CsvLog(tmp_path, datetime(2025, 1, 16, 12, 4, 57), columns=columns) as log:
        log.write(row(0))
        for second in range(1, 10):
            metrics.add_scan([0.15 + 0.1 * second, 3.0])
            metrics.add_imu((1.0, 2.0, 9.8 * second), (0.1, 0.2, 0.3))
            metrics.add_pose((0.25 * second, 0.0, 0.0))
            metrics.add_odometry((0.25, 0.0, 0.0))
            log.write(row(second))
    return log.path


def test_plain_read_csv_finds_every_column_in_its_place(log: Path) -> None:
    table = pd.read_csv(log)
    assert isinstance(table.index, pd.RangeIndex)  # no column was taken for an index
    assert table["Timestamp"].tolist() == list(range(10))
    assert table["Distance Traveled"].tolist() == [0.0, 0.0] + [0.25 * i for i in range(1, 9)]
    assert (table["Notes"] == "Normal operation").all()


def test_every_column_the_analyzer_needs_is_there_and_numeric(log: Path) -> None:
    table = pd.read_csv(log)
    for column in ANALYZER_COLUMNS:
        assert is_numeric_dtype(table[column]), column
        assert table[column].notna().all(), column
    infinite = table.drop(columns="Notes").stack()[lambda cells: cells.abs() == float("inf")]
    assert list(infinite.index) == [(0, "Obstacle Clearance")]  # before the first range


def test_the_header_is_the_first_line_and_no_row_is_longer_or_shorter(log: Path) -> None:
    lines = log.read_text(encoding="ascii").splitlines()
    assert lines[0].startswith("Timestamp,Total Collisions,")
    assert lines[0].split(",")[:12] == list(COLUMNS)
    assert {line.count(",") for line in lines} == {lines[0].count(",")}
    assert not any(name.startswith("Unnamed") or not name.strip() for name in lines[0].split(","))
    assert '"' not in log.read_text()


def test_a_log_reads_the_same_when_its_last_line_is_cut(log: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.csv"
    cut.write_bytes(log.read_bytes()[:-30])
    whole, rest = pd.read_csv(log), pd.read_csv(cut)
    assert isinstance(rest.index, pd.RangeIndex)
    pd.testing.assert_frame_equal(whole.iloc[:-1], rest.iloc[:-1], check_dtype=False)
