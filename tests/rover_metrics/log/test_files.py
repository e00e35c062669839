import errno
import json
import math
from pathlib import Path

import numpy as np
import pytest

from rover_metrics.log.files import json_safe, whole_file, write_whole


def test_a_file_takes_its_place_when_it_is_whole(tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    target.write_text("old")
    before = set(Path("/proc/self/fd").iterdir())
    with whole_file(target) as part:
        part.write_text("new")
        assert part.parent == tmp_path  # on the disk on which it stays
        assert target.read_text() == "old"
    assert set(Path("/proc/self/fd").iterdir()) <= before
    assert target.read_text() == "new"
    assert target.stat().st_mode & 0o777 == 0o644
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


@pytest.mark.parametrize(
    ("name", "written"), [(b"\xc3\xa9", "é"), (b"\xe9", "\ufffd"), (b"\xed\xa0\x80", "\ufffd" * 3)]
)
def test_a_file_that_names_any_other_is_text(tmp_path: Path, name: bytes, written: str) -> None:
    write_whole(tmp_path / "page.html", f"{name.decode('ascii', 'surrogateescape')}\r\n")
    assert (tmp_path / "page.html").read_bytes().decode() == written + "\r\n"


@pytest.mark.parametrize("old", [{"page.html": "old"}, {}])
def test_a_failed_write_leaves_what_was_there(tmp_path: Path, old: dict[str, str]) -> None:
    for name, text in old.items():
        (tmp_path / name).write_text(text)
    with pytest.raises(OSError, match="full"), whole_file(tmp_path / "page.html") as part:  # noqa: PT012
        part.write_text("half")
        raise OSError(errno.ENOSPC, "the disk is full")
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == old


def test_json_has_null_for_what_no_number_is_lists_for_tuples_and_as_many_digits_as_asked_for() -> None:
    values = {
        1: (math.inf, -math.inf, math.nan),
        "a": {"b": [0.123456, np.float64("nan"), 3, None, True, "x"]},
    }
    for digits, number in ((None, 0.123456), (3, 0.123), (0, 0.0)):
        safe = json_safe(values, digits)
        assert safe == {"1": [None, None, None], "a": {"b": [number, None, 3, None, True, "x"]}}
        assert json.loads(json.dumps(safe, allow_nan=False)) == safe
