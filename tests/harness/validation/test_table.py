import io
from pathlib import Path

import pytest
from rich.console import Console

from harness.errors import UsageError
from harness.robots import MODELS_DIR
from harness.validation.check import Check, Span
from harness.validation.table import (
    BEGIN,
    END,
    as_markdown,
    listed_quantities,
    print_table,
    write_between_markers,
)

GOOD = Check("|a| at rest", "m/s2", Span(9.795, 9.805, "S: gravity"), 9.8)
BAD = Check("speed", "m/s", Span(0.49, 0.50, "S: recorded"), 0.42, digits=2)


def test_the_readme_lists_the_quantities_of_the_suite(driven: dict[str, list[Check]]) -> None:
    measured = {robot: [check.quantity for check in checks] for robot, checks in driven.items()}
    assert listed_quantities(MODELS_DIR / "README.md") == {
        robot: [name.replace("|", "\\|") for name in names] for robot, names in measured.items()
    }, "run python -m harness.validate --write"


def test_writing_replaces_what_stands_between_the_markers_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "README.md"
    path.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n", encoding="utf-8")
    write_between_markers(path, as_markdown({"leo": [GOOD, BAD]}))
    text = path.read_text(encoding="utf-8")
    assert text.startswith("before\n")
    assert text.endswith("\nafter\n")
    assert "old" not in text
    assert "| speed | 0.49 to 0.50 m/s | 0.42 m/s | MISS | S: recorded |" in text
    assert listed_quantities(path) == {"leo": ["\\|a\\| at rest", "speed"]}
    write_between_markers(path, as_markdown({"leo": [GOOD, BAD]}))
    assert path.read_text(encoding="utf-8") == text


def test_a_file_without_markers_is_left_alone_with_one_line(tmp_path: Path) -> None:
    path = tmp_path / "README.md"
    path.write_text("nothing", encoding="utf-8")
    with pytest.raises(UsageError, match="must hold"):
        write_between_markers(path, "table")
    assert path.read_text(encoding="utf-8") == "nothing"


def test_a_missing_file_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="cannot rewrite"):
        write_between_markers(tmp_path / "none.md", "table")


def test_the_terminal_shows_expected_measured_verdict_and_source() -> None:
    console = Console(file=io.StringIO(), width=160)
    print_table(console, "leo", [GOOD, BAD])
    assert isinstance(console.file, io.StringIO)
    line = next(line for line in console.file.getvalue().splitlines() if "speed" in line)
    for cell in ("0.49 to 0.50 m/s", "0.42 m/s", "MISS", "S: recorded"):
        assert cell in line
