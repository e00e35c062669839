from pathlib import Path

import pytest

from harness.errors import UsageError
from harness.validation.recorded import COLUMNS, read_log

HEADER = ",".join(["Timestamp", *COLUMNS])


def test_a_log_is_read_by_column_without_the_rows_before_the_first_scan(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(f"{HEADER}\n1,9.8,9.7,0.1,inf\n2,10.5, 9.1,0.3,2.5\n")
    log = read_log(path)
    assert {column: values.tolist() for column, values in log.items()} == dict(
        zip(COLUMNS, ([10.5], [9.1], [0.3], [2.5]), strict=True)
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "holds no complete row"),
        (f"{HEADER}\n", "holds no complete row"),
        (f"{HEADER}\n1,9.8,9.7,0.1,inf\n", "holds no complete row"),
        ("Timestamp,Notes\n1,fine\n", "needs numbers in"),
        (f"{HEADER}\n1,rough,9.7,0.1,2\n", "needs numbers in"),
        (f"{HEADER}\n1,9.8\n", "needs numbers in"),
    ],
)
def test_a_file_that_is_no_log_is_one_line(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(text)
    with pytest.raises(UsageError, match=said):
        read_log(path)


def test_a_log_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="--realism takes two logs"):
        read_log(tmp_path / "none.csv")


def test_a_log_that_is_not_text_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(UsageError, match="needs numbers in"):
        read_log(path)
