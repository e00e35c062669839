"""The data dictionary has what the code says."""

from pathlib import Path

import pytest

from rover_metrics.dictionary import main
from rover_metrics.extended.metrics import EXTENDED_HEADER

DOCUMENT = Path(__file__).parents[2] / "docs/metrics.md"


def test_every_column_is_in_it_once_as_in_the_document(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    printed = capsys.readouterr().out
    assert printed in DOCUMENT.read_text(encoding="utf-8")
    assert len(set(EXTENDED_HEADER)) == len(EXTENDED_HEADER)
    for name in EXTENDED_HEADER:
        assert printed.count(f"| `{name}` |") == 1, name
