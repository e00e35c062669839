"""Local processes: everything once, whatever happens to a worker; nothing is left behind."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from types import ModuleType

import pytest

from harness.tune.backend import WorkerLost, backend_of
from harness.tune.backend.local import LocalBackend
from tests.support.waiting import PATIENCE, wait_until

HERE = Path(__file__).parent
# A command that works with two processes until it is stopped.
COMMAND = """
import sys
from pathlib import Path
from harness.base.errors import HarnessError
from harness.base.interrupt import StopRequest
from harness.tune.backend import backend_of
from stand_ins import hang_after_the_first
folder = Path(sys.argv[1])
try:
    with StopRequest(), backend_of("local", None, 2) as backend:
        for done in backend.map(hang_after_the_first, [(number, folder) for number in range(8)]):
            (folder / f"{done}.done").touch()
except HarnessError as error:
    print(error, file=sys.stderr)
    sys.exit(error.exit_code)
"""


@pytest.fixture
def two_processes() -> Iterator[LocalBackend]:
    with LocalBackend(2) as backend:
        yield backend


def test_every_item_comes_back_once_from_one_thread_whatever_the_environment_says(
    two_processes: LocalBackend, stand_ins: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "4")

    found = list(two_processes.map(stand_ins.square_and_threads, range(20)))

    assert sorted(found) == [(number, number * number, "1") for number in range(20)]
    assert list(two_processes.map(stand_ins.square_and_threads, [])) == []


def test_closing_early_ends_without_a_word(
    two_processes: LocalBackend, stand_ins: ModuleType, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    items = [(number, tmp_path) for number in range(4)]

    with closing(two_processes.map(stand_ins.hang_after_the_first, items)) as outcomes:
        assert next(outcomes) == 0

    assert capfd.readouterr() == ("", "")


def test_a_killed_worker_is_told_and_the_rest_can_be_done(
    two_processes: LocalBackend, stand_ins: ModuleType, tmp_path: Path
) -> None:
    items = [(number, tmp_path / "died") for number in range(6)]
    found: list[int] = []

    with pytest.raises(WorkerLost, match="a worker process was killed"):
        found.extend(two_processes.map(stand_ins.die_the_first_time, items))
    found.extend(two_processes.map(stand_ins.die_the_first_time, items[3:4]))

    assert found[-1] == 3
    assert len(found) == len(set(found))


def test_what_work_raises_comes_out(two_processes: LocalBackend, stand_ins: ModuleType) -> None:
    with pytest.raises(ValueError, match="three"):
        list(two_processes.map(stand_ins.fail_at_3, range(5)))


def test_one_job_needs_no_other_process(stand_ins: ModuleType, tmp_path: Path) -> None:
    with LocalBackend(1) as backend:
        assert list(backend.map(stand_ins.hang_after_the_first, [(0, tmp_path)])) == [0]

    assert int((tmp_path / "0.pid").read_text()) == os.getpid()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_a_signal_to_all_processes_of_a_terminal_ends_them_in_one_line(
    command: subprocess.Popen[str], tmp_path: Path, number: signal.Signals
) -> None:
    wait_until((tmp_path / "0.done").exists)

    os.killpg(command.pid, number)
    _, told = command.communicate(timeout=PATIENCE)

    assert (command.returncode, told) == (128 + number, f"stopped by {number.name}\n")
    wait_until(lambda: not living(tmp_path))


def test_workers_leave_when_the_command_is_killed(
    command: subprocess.Popen[str], tmp_path: Path
) -> None:
    wait_until(lambda: len(list(tmp_path.glob("*.pid"))) == 3)

    command.kill()

    wait_until(lambda: not living(tmp_path))


@pytest.fixture
def command(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """COMMAND in a process group of its own, as a shell starts it."""
    path = os.pathsep.join((str(HERE), os.environ.get("PYTHONPATH", ""), *sys.path))
    with subprocess.Popen(
        [sys.executable, "-c", COMMAND, str(tmp_path)],
        env={**os.environ, "PYTHONPATH": path},
        start_new_session=True,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        yield process
        process.kill()


def living(folder: Path) -> list[int]:
    """Ids of workers that still run."""
    return [pid for file in folder.glob("*.pid") if runs(pid := int(file.read_text()))]


def runs(pid: int) -> bool:
    """Nobody may have asked for the exit code of a process that has ended: such a one does not run."""
    words = ["ps", "-o", "stat=", "-p", str(pid)]
    state = subprocess.run(words, capture_output=True, text=True, check=False).stdout
    return bool(state) and not state.startswith("Z")


def test_as_many_jobs_as_usable_cpus_by_default() -> None:
    with backend_of("local", None, None) as backend:
        assert isinstance(backend, LocalBackend)
        assert backend.jobs == len(os.sched_getaffinity(0))
