"""Files of strangers are refused in a line, whatever they hold."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from rover_metrics.log import bounded
from rover_metrics.log.bounded import read_json, read_yaml

DIGITS = "9" * 5001


@pytest.mark.parametrize(
    ("read", "text", "reason"),
    [
        (read_json, "[" * 100_000 + "]" * 100_000, "nested more than"),
        (read_json, f"[{DIGITS}]", "integer of 5001 digits"),
        (read_json, f"[{DIGITS[:400]}]", "integer of 400 digits"),
        (read_json, "{", "Expecting property name"),
        (read_json, "\udcff", "codec can't decode"),
        (read_yaml, "[" * 5000 + "]" * 5000, "nested more than"),
        (read_yaml, "a: &a [1]\nb: [*a, *a]", r"alias \(\*a\)"),
        (read_yaml, f"a: {DIGITS}", "integer of 5001 digits"),
        (read_yaml, "a: 2020-99-99", "month"),
        (read_yaml, "!!python/object:os.system x", "constructor"),
        (read_yaml, "a:\n\t- b", "found character"),
    ],
)
def test_what_is_beyond_the_bounds_is_refused_in_a_line(
    read: Callable[[Path], Any], text: str, reason: str, tmp_path: Path
) -> None:
    file = tmp_path / "file"
    file.write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ValueError, match=reason) as told:
        read(file)
    assert "\n" not in str(told.value)


def test_what_is_no_file_or_too_large_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match="no file"):
        read_json(tmp_path / "pipe")
    with pytest.raises(OSError, match="Input/output error"):
        read_json(Path("/proc/self/mem"))
    (tmp_path / "list").write_text("[1, 2.5]")
    assert read_json(tmp_path / "list") == read_yaml(tmp_path / "list") == [1, 2.5]
    monkeypatch.setattr(bounded, "MOST_BYTES", 7)
    with pytest.raises(ValueError, match="larger than"):
        read_yaml(tmp_path / "list")
