"""XML of strangers: what is refused, and that nothing of it is expanded."""

from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.world.sdf.reader import read_xml


def test_a_large_or_missing_file_is_refused_and_a_hundred_elements_in_each_other_are_read(
    tmp_path: Path,
) -> None:
    path = tmp_path / "a.world"
    path.write_text("<sdf>" + " " * 100 + "</sdf>")
    with pytest.raises(UsageError, match="larger than 110 bytes"):
        read_xml(path, most_bytes=110)
    assert read_xml(path, most_bytes=111).tag == "sdf"
    with pytest.raises(UsageError, match=r"cannot read .*: No such file"):
        read_xml(tmp_path / "b.world")
    with pytest.raises(UsageError, match="embedded null byte"):
        read_xml(tmp_path / "b\0.world")
    path.write_text("<a>" * 99 + "<b/><c/>" + "</a>" * 99)
    assert [element.tag for element in read_xml(path).iter()] == ["a"] * 99 + ["b", "c"]
