import os
import signal
import stat
import sys
import threading
from pathlib import Path

import pytest

from harness.base.errors import HarnessError, UsageError
from harness.base.files import check_target, whole_file, write_whole


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("run.mp3", r"--video '.*run\.mp3': name a file that ends in \.mp4"),
        ("folder.mp4", r"--video .*folder\.mp4 is a folder; name a file"),
        ("absent/run.mp4", r"--video .*: there is no folder .*absent; create it first"),
        ("/proc/run.mp4", r"--video /proc/run\.mp4 cannot be written: [A-Z].*; choose another place"),
        ("a" * 300 + ".mp4", r"--video .* cannot be written: File name too long"),
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


def test_a_device_or_a_pipe_is_written_into_and_stays_what_it_is(tmp_path: Path) -> None:
    pipe, link, read = tmp_path / "pipe", tmp_path / "link", list[str]()
    os.mkfifo(pipe)
    link.symlink_to(pipe)
    for target in (pipe, link):
        check_target("--json", target)
        reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
        reader.start()
        write_whole(target, "some text\n")
        reader.join()
    assert read == ["some text\n"] * 2
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link", "pipe"]
    with pytest.raises(HarnessError, match="cannot write the page to /dev/full: No space"):
        write_whole(Path("/dev/full"), "some text", "the page")
    assert stat.S_ISCHR(Path("/dev/full").stat().st_mode)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_while_a_file_is_written_leaves_nothing_of_it(
    number: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(sys.modules, "rclpy", raising=False)  # whose handlers are left alone
    before = signal.signal(number, signal.SIG_DFL)
    try:
        with pytest.raises(SystemExit) as left, whole_file(tmp_path / "a.json"):
            signal.raise_signal(number)
        assert signal.getsignal(number) is signal.SIG_DFL
    finally:
        signal.signal(number, before)
    assert left.value.code == 128 + number
    assert list(tmp_path.iterdir()) == []
