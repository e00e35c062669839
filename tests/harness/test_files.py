import errno
from pathlib import Path

import pytest

from harness.errors import UsageError
from harness.files import check_target, whole_file


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


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("run.mp3", r"--video '.*run\.mp3': name a file that ends in \.mp4"),
        ("folder.mp4", r"--video .*folder\.mp4 is a folder; name a file"),
        ("absent/run.mp4", r"--video .*: there is no folder .*absent; create it first"),
        ("/proc/run.mp4", r"--video /proc/run\.mp4 cannot be written: [A-Z].*; choose another place"),
    ],
)
def test_a_target_that_cannot_be_written_is_refused(name: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(UsageError, match=message):
        check_target("--video", tmp_path / name, ".mp4")


@pytest.mark.parametrize("name", ["run.mp4", "RUN.MP4"])
def test_a_target_that_can_be_written_is_not_touched(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text("old")
    check_target("--video", tmp_path / name, ".mp4")
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == "old"


def test_a_target_may_have_any_name_where_none_is_asked_for(tmp_path: Path) -> None:
    check_target("--summary", tmp_path / "run")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(UsageError, match=r"--summary .* is a folder; name a file"):
        check_target("--summary", tmp_path)
    with pytest.raises(UsageError, match=r"there is no folder .*; create it first"):
        check_target("--summary", tmp_path / "absent" / "run.json")


def test_a_file_is_there_whole_or_not_at_all(tmp_path: Path) -> None:
    target = tmp_path / "a.png"

    def fail() -> None:
        with whole_file(target) as part:
            part.write_text("half")
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert list(tmp_path.iterdir()) == []
