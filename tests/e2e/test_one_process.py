"""harness.run with a hosted MetricsNode over real DDS, from command line to CSV."""

import json
from pathlib import Path

import pytest

from harness.run import main
from rover_metrics.core.columns import Row
from rover_metrics.errors import LogError
from rover_metrics.log.csv_log import CsvLog

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")


@pytest.mark.usefixtures("ros_domain")
def test_a_row_that_the_disk_takes_at_the_end_is_no_lost_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, refusals = CsvLog.write, iter([LogError("no space")])

    def write_late(log: CsvLog, row: Row) -> None:
        if log.rows == 1 and (refusal := next(refusals, None)):
            raise refusal
        write(log, row)

    monkeypatch.setattr(CsvLog, "write", write_late)
    assert main(["--terrain", "flat", "--duration", "2", "--log-dir", str(tmp_path)]) == 0
    (log,) = tmp_path.glob("*.csv")
    assert len(log.read_bytes().splitlines()) == 1 + 2
    assert json.loads(log.with_suffix(".json").read_text())["rows"] == 2
