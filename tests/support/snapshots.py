"""Outputs, compared whole with what somebody has looked at; with ACCEPT=1 set the new ones are kept."""

import os
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "snapshots"


def check_snapshot(name: str, text: str) -> None:
    """Compares a text with the one kept under this name."""
    path = FOLDER / name
    if os.environ.get("ACCEPT"):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    kept = path.read_text(encoding="utf-8") if path.exists() else ""
    assert text.splitlines() == kept.splitlines(), f"is it right? ACCEPT=1 keeps it: {path}"
