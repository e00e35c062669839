"""Tables that a command prints, as files where they are asked for: --page, --csv, --json."""

import argparse
import json
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from harness.base.errors import UsageError
from harness.base.files import PAGES, check_target, write_whole
from rover_metrics.sheet.render import csv_of
from rover_metrics.sheet.sheet import Sheet

FILES = {
    "page": "write the tables as a page",
    "csv": "write their rows, each behind the name of its table",
    "json": "write their rows by the names of the tables",
}


def add_files(parser: argparse.ArgumentParser, names: Collection[str] = FILES.keys()) -> None:
    """Adds the options that name the files, or those of some `names`."""
    for name in names:
        about = f"{FILES[name]}; default: none"
        parser.add_argument(f"--{name}", type=Path, metavar="FILE", help=about)


def files_of(options: argparse.Namespace) -> dict[str, Path]:
    """Returns the files that are asked for, by option; UsageError if one cannot be written."""
    files = {name: getattr(options, name) for name in FILES if getattr(options, name) is not None}
    for name, path in files.items():
        check_target(f"--{name}", path, *(PAGES if name == "page" else ()))
    return files


def write_sheets(files: Mapping[str, Path], heading: str, sheets: Sequence[Sheet]) -> None:
    """Writes tables into the files that are asked for.

    Args:
        files: By format: "json", "csv" or "page".
        heading: Of the page.
        sheets: The tables; their titles are the keys of the JSON.

    Raises:
        UsageError: A file cannot be written.
    """
    if "json" in files:
        rows = {
            sheet.title: [dict(zip(sheet.titles, row, strict=True)) for row in sheet.rows]
            for sheet in sheets
        }
        text = json.dumps(rows, indent=2, ensure_ascii=False) + "\n"
        write_whole(files["json"], text, "the tables", UsageError)
    if "csv" in files:
        write_whole(files["csv"], csv_of(sheets), "the tables", UsageError)
    if "page" in files:
        from harness.page.shell import fill  # noqa: PLC0415 - most do without

        text = fill("sheets", {"heading": heading, "sheets": sheets}, "harness.page")
        write_whole(files["page"], text, "the page", UsageError)
