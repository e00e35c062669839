"""--page, --csv and --json: the same words wherever tables are printed, and the same cells in each."""

import argparse
import csv
import json
from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.cli.sheets import FILES, add_files, files_of, write_sheets
from rover_metrics.sheet.sheet import Sheet
from tests.test_help import PROGRAMS

TABLES = [
    Sheet(("quantity", "measured"), (("mass", "<1 kg"), ("track", "0.4 m")), "leo"),
    Sheet(("soil", "stalls at"), (("sand", "17"),), "slopes", caption="of dry ones"),
]
PRINT_TABLES = ("check", "validate", "tune", "robot check", "gym.policy evaluate", "scenario")


def parsed(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add_files(parser)
    return parser.parse_args(words)


def test_each_file_holds_every_cell(tmp_path: Path) -> None:
    words = [word for name in FILES for word in (f"--{name}", str(tmp_path / name))]
    write_sheets(files_of(parsed(*words)), "Tables", TABLES)
    with (tmp_path / "csv").open(newline="") as file:
        rows = [{name: cell for name, cell in row.items() if cell} for row in csv.DictReader(file)]
    records = [
        {"table": sheet.title} | dict(zip(sheet.titles, row, strict=True))
        for sheet in TABLES
        for row in sheet.rows
    ]
    assert rows == records
    kept = json.loads((tmp_path / "json").read_text())
    assert [{"table": title} | row for title, table in kept.items() for row in table] == records
    page = (tmp_path / "page").read_text()
    assert all(text in page for text in ("leo", "slopes", "of dry ones", "&lt;1 kg", "0.4 m", "17"))


def test_nothing_is_written_unless_it_is_asked_for_and_can_be(tmp_path: Path) -> None:
    write_sheets(files_of(parsed()), "Tables", TABLES)
    with pytest.raises(UsageError, match="there is no folder"):
        files_of(parsed("--csv", str(tmp_path / "none/a.csv")))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("program", PRINT_TABLES)
def test_every_command_that_prints_tables_has_them(program: str) -> None:
    options = PROGRAMS[f"harness.{program}"]()._option_string_actions
    assert {options[f"--{name}"].metavar for name in FILES} == {"FILE"}
