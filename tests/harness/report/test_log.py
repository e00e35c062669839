import math
from pathlib import Path

import pytest

from harness.report.log import Log, read_log


def test_a_log_is_read_back_as_numbers_and_counted_notes(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    rows = ["Timestamp,A,B [m],Notes", "1,2.5,inf,calm", "2,x,4,calm", '3,1,,"rough, fast"', "4,7"]
    path.write_text("\r\n".join(rows) + "\r\n")
    log = read_log(path)
    assert log.time_s == [1.0, 2.0, 3.0, 4.0]
    assert log.columns == {
        "A": pytest.approx([2.5, math.nan, 1.0, 7.0], nan_ok=True),
        "B [m]": pytest.approx([math.inf, 4.0, math.nan, math.nan], nan_ok=True),
    }
    assert log.notes == [("calm", 2), ("rough, fast", 1), ("", 1)]
    assert read_log(None) == read_log(tmp_path / "absent.csv") == Log()
