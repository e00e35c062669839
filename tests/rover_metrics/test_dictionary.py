"""The data dictionary is what the code says."""

from pathlib import Path

import pytest

from rover_metrics.dictionary import main
from rover_metrics.extended.metrics import EXTENDED_HEADER

DOCUMENT = Path(__file__).parents[2] / "docs/metrics.md"


def test_the_document_is_what_the_code_gives(tmp_path: Path) -> None:
    made = tmp_path / "metrics.md"
    assert main(["--write", str(made)]) == 0
    assert DOCUMENT.read_text() == made.read_text(), (
        "run: python -m rover_metrics.dictionary --write ..."
    )


def test_every_column_is_in_it_once_and_no_two_share_a_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    told = capsys.readouterr().out
    assert len(set(EXTENDED_HEADER)) == len(EXTENDED_HEADER)
    assert told == DOCUMENT.read_text(encoding="utf-8")
    for name in EXTENDED_HEADER:
        assert told.count(f"| `{name}` |") == 1, name


def test_a_place_that_cannot_be_written_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--write", "/nowhere/metrics.md"]) == 2
    assert capsys.readouterr().err == (
        "dictionary: cannot use /nowhere/metrics.md: No such file or directory; name another place\n"
    )


def test_it_replaces_its_own_pages_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "metrics.md"
    assert main(["--write", str(page)]) == main(["--write", str(page)]) == 0
    page.write_text("mine")
    assert main(["--write", str(page)]) == 2
    told = f"dictionary: {page} was not made by this command; name another file\n"
    assert capsys.readouterr().err == told
    assert page.read_text() == "mine"
