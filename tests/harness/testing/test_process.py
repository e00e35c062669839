"""Programs that a trial starts: found, missed, told of, and gone with all that they have started."""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.base.errors import RunFailed, UsageError
from harness.testing.process import BECOME, LAST_LINES, Process, Programs
from tests.support.waiting import wait_until

# A child that does not hear Ctrl-C, and a program that does.
FAMILY = "trap '' INT; sleep 1000 & echo $!; trap - INT; exec sleep 1000"
# Starts a program, prints its number when it is what it becomes, and ends.
PARENT = """\
import os, pathlib, subprocess, sys
sys.argv.insert(6, str(os.getpid()))
pid = subprocess.Popen(sys.argv[1:]).pid
while pathlib.Path(f"/proc/{pid}/comm").read_text().strip() != "sleep":
    pass
print(pid)
"""


def is_gone(pid: int) -> bool:
    """Whether a process runs no more; nobody may have collected it."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


def test_stop_ends_all_that_a_program_has_started_also_where_signals_are_blocked(tmp_path: Path) -> None:
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])  # as in a worker
    try:
        process = Process(["sh", "-c", FAMILY], os.environ, output=tmp_path / "said")
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    wait_until((tmp_path / "said").read_text)
    process.check()
    process.stop()
    assert process._process.returncode == -signal.SIGINT
    wait_until(lambda: is_gone(int((tmp_path / "said").read_text())))
    process.stop()  # once more does no harm
    with pytest.raises(RunFailed, match=r"^sh -c '.*' ended by SIGINT at 3 s\n\d+$"):
        process.check(" at 3 s")


def test_whichever_of_several_programs_ends_is_told_of_with_the_time_and_knows_its_domain(
    tmp_path: Path,
) -> None:
    programs = Programs(42, lambda: " at 7 s")
    ended = ["sh", "-c", "echo $ROS_DOMAIN_ID; exit 3"]
    lasting = [programs.begin(["sleep", "1000"])]
    programs.check()
    told = programs.begin(ended, output=tmp_path / "said")
    lasting.append(programs.begin(["sleep", "1000"]))
    told._process.wait()
    try:
        with pytest.raises(RunFailed, match=r"ended with exit code 3 at 7 s\n42$"):
            programs.check()
    finally:
        for process in lasting:
            process.stop()


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends children with their parents")
def test_a_program_ends_with_whoever_started_it() -> None:
    become = [sys.executable, "-I", "-S", "-c", BECOME]
    words = [sys.executable, "-I", "-S", "-c", PARENT, *become, "sleep", "1000"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    wait_until(lambda: is_gone(int(done.stdout)))


def ended(tmp_path: Path, code: str, *, may_end: bool = False) -> Process:
    process = Process(["sh", "-c", code], os.environ, output=tmp_path / "said", may_end=may_end)
    process._process.wait()
    return process


def test_what_a_program_said_last_is_told_if_it_ends_and_may_not(tmp_path: Path) -> None:
    ended(tmp_path, "exit 0", may_end=True).check()
    for may_end, code in ((False, 0), (True, 3)):
        process = ended(tmp_path, f"seq 100; echo; exit {code}", may_end=may_end)
        with pytest.raises(RunFailed, match=f" ended with exit code {code}\n") as caught:
            process.check()
        assert str(caught.value).splitlines()[1:] == [str(n) for n in range(101 - LAST_LINES, 101)]


def test_programs_are_those_of_this_pythons_environment(tmp_path: Path) -> None:
    ended(tmp_path, "command -v python; pwd")
    found, _ = (tmp_path / "said").read_text().splitlines()
    assert (Path(found).parent == Path(sys.prefix, "bin")) == (sys.prefix != sys.base_prefix)
    (tmp_path / "own").touch(mode=0o755)
    for name, folder in (("slep", None), ("./own", None), ("./other", tmp_path)):
        with pytest.raises(UsageError, match=re.escape(f"there is no program '{name}' to launch (")):
            Process([name, "1"], os.environ, folder=folder)
    Process(["./own"], os.environ, folder=tmp_path).stop()
