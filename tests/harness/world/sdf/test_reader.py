"""XML of strangers: what is refused, and that nothing of it is expanded."""

from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.world.sdf.reader import is_true, numbers, read_xml, text_of


def test_a_large_or_missing_file_is_refused_and_a_hundred_elements_in_each_other_are_read(
    tmp_path: Path,
) -> None:
    path = tmp_path / "a.world"
    path.write_text("<sdf>" + " " * 100 + "</sdf>")
    with pytest.raises(UsageError, match="too large"):
        read_xml(path, most_bytes=110)
    assert read_xml(path, most_bytes=111).tag == "sdf"
    with pytest.raises(UsageError, match=r"cannot be read: No such file"):
        read_xml(tmp_path / "b.world")
    with pytest.raises(UsageError, match=r"cannot be read: embedded null byte"):
        read_xml(tmp_path / "b\0.world")
    path.write_text("<a>" * 99 + "<b/><c/>" + "</a>" * 99)
    assert [element.tag for element in read_xml(path).iter()] == ["a"] * 99 + ["b", "c"]


def test_children_have_texts_flags_and_numbers(tmp_path: Path) -> None:
    (path := tmp_path / "a.world").write_text("<a><b> 1 2.5\n-3 </b><c>TRUE</c><d/><e> </e></a>")
    root = read_xml(path)
    assert numbers(text_of(root, "b"), 3, "b") == (1.0, 2.5, -3.0)
    assert (is_true(text_of(root, "c")), is_true(text_of(root, "d", "0"))) == (True, False)
    assert [text_of(None, "b", "no"), *(text_of(root, tag, "no") for tag in "dex")] == ["no"] * 4
    for text in ("1 2", "1 2 3 4", "1 2 x", "1 2 nan", "1 2 inf", ""):
        with pytest.raises(UsageError, match=r"size '.*' is not valid; give 3 finite numbers"):
            numbers(text, 3, "size")
