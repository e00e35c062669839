import errno
import json
import math
from pathlib import Path

import numpy as np
import pytest

from rover_metrics.log.files import json_safe, whole_file


def test_a_file_takes_its_place_when_it_is_whole(tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    target.write_text("old")
    with whole_file(target) as part:
        part.write_text("new")
        assert part.parent == tmp_path
        assert target.read_text() == "old"
    assert target.read_text() == "new"
    assert target.stat().st_mode & 0o777 == 0o644
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_a_file_that_could_not_be_written_leaves_what_was_there(tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    target.write_text("old")

    def write_half() -> None:
        with whole_file(target) as part:
            part.write_text("half")
            raise OSError(errno.ENOSPC, "the disk is full")

    with pytest.raises(OSError, match="full"):
        write_half()
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_a_link_is_replaced_and_what_it_points_to_stays(tmp_path: Path) -> None:
    other, target = tmp_path / "other", tmp_path / "link"
    other.write_text("precious")
    target.symlink_to(other)
    with whole_file(target) as part:
        part.write_text("new")
    assert other.read_text() == "precious"
    assert not target.is_symlink()


def test_a_file_is_there_whole_or_not_at_all(tmp_path: Path) -> None:
    target = tmp_path / "a.png"

    def fail() -> None:
        with whole_file(target) as part:
            part.write_text("half")
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert list(tmp_path.iterdir()) == []


def test_json_has_null_for_what_no_number_is_and_lists_for_tuples() -> None:
    values = {
        1: (math.inf, -math.inf, math.nan),
        "a": {"b": [0.25, np.float64("nan"), 3, None, True, "x"]},
    }
    safe = json_safe(values)
    assert safe == {"1": [None, None, None], "a": {"b": [0.25, None, 3, None, True, "x"]}}
    assert json.loads(json.dumps(safe, allow_nan=False)) == safe


def test_floats_are_rounded_only_if_asked_for() -> None:
    assert json_safe([0.123456, 7]) == [0.123456, 7]
    assert json_safe([0.123456, 7, math.inf], digits=3) == [0.123, 7, None]


def test_a_written_file_is_left_open_by_nobody(tmp_path: Path) -> None:
    def open_files() -> int:
        return len(list(Path("/proc/self/fd").iterdir()))

    before = open_files()
    for _ in range(20):
        with whole_file(tmp_path / "page.html") as part:
            part.write_text("new")
    assert open_files() < before + 20
