"""Outputs, compared whole with what somebody has looked at; with ACCEPT=1 set the new ones are kept."""

import os
import re
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "snapshots"


def check_snapshot(name: str, text: str) -> None:
    """Compares a text with the one kept under this name."""
    path = FOLDER / name
    if os.environ.get("ACCEPT"):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    kept = path.read_text(encoding="utf-8") if path.exists() else ""
    assert _rounded(text).splitlines() == _rounded(kept).splitlines(), (
        f"is it right? ACCEPT=1 keeps it: {path}"
    )


def _rounded(text: str) -> str:
    """A text whose long numbers have twelve digits: the last ones differ with the version of NumPy."""
    return re.sub(r"\d+\.\d{12,}(e-?\d+)?", lambda number: f"{float(number[0]):.12g}", text)
