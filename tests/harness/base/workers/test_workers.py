"""Workers of this machine, and what a user may choose: everything is done once and nothing is left."""

import argparse
import gc
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from harness.base.errors import RunFailed, UsageError
from harness.base.workers import WorkerLost, add_options, work_off, workers_of
from harness.base.workers import clusters as module
from harness.base.workers.clusters import Cluster, versions
from harness.base.workers.local import LocalWorkers
from tests.support.waiting import PATIENCE, wait_until

HERE = Path(__file__).parent
# A command that works with two processes until it is stopped.
COMMAND = """
import sys
from pathlib import Path
from harness.base.errors import HarnessError
from harness.base.interrupt import StopRequest
from harness.base.workers import workers_of
from stand_ins import hang_after_the_first
folder = Path(sys.argv[1])
try:
    with StopRequest(), workers_of("local", jobs=2) as workers:
        for done in workers.map(hang_after_the_first, [(number, folder) for number in range(8)]):
            (folder / f"{done}.done").touch()
except HarnessError as error:
    print(error, file=sys.stderr)
    sys.exit(error.exit_code)
"""


@pytest.fixture
def two() -> LocalWorkers:
    return LocalWorkers(2)


def test_every_item_comes_back_once_from_one_thread_whatever_the_environment_says(
    two: LocalWorkers, stand_ins: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "4")
    outcomes = sorted(two.map(stand_ins.square_and_threads, range(20)))
    assert outcomes == [(number, number * number, "1") for number in range(20)]
    assert list(two.map(stand_ins.square_and_threads, [])) == []
    with pytest.raises(ValueError, match="three"):
        list(two.map(stand_ins.fail_at_3, range(5)))
    kept = dict[str, int]()
    items = {f"n{n}": (n, tmp_path / "died") for n in range(6)}  # one worker is killed
    work_off(items, stand_ins.die_the_first_time, two, kept.__setitem__, name=str, mend="try again")
    assert (kept, (tmp_path / "died").exists()) == ({f"n{n}": n for n in range(6)}, True)


def test_outcomes_come_as_they_are_done_and_closing_early_ends_silently(
    two: LocalWorkers, stand_ins: ModuleType, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    items = [(number, tmp_path) for number in (3, 0, 1)]  # all but 0 hang
    with closing(two.map(stand_ins.hang_after_the_first, items)) as outcomes:
        assert next(outcomes) == 0
    wait_until(lambda: not living(tmp_path))
    assert capfd.readouterr() == ("", "")


def test_work_that_kills_every_worker_is_given_up_and_named(
    two: LocalWorkers, stand_ins: ModuleType
) -> None:
    kept: list[int] = []
    every = {n: n for n in (3, 3.0, 5)}
    with pytest.raises(RunFailed, match=r"^a worker of this machine was killed .*not done: 3.*; mend$"):
        work_off(every, stand_ins.die_at_3, two, lambda _, n: kept.append(n), name=str, mend="mend")
    assert set(kept) <= {5}


class Flaky(LocalWorkers):
    """Loses a worker after each outcome, and a few times before the first."""

    def __init__(self, failures: int) -> None:
        super().__init__(1)
        self.failures = failures

    def map(self, work: Callable[[Any], Any], items: Sequence[Any]) -> Generator[Any, None, None]:
        if self.failures:
            self.failures -= 1
            raise WorkerLost("lost")
        yield work(items[0])
        raise WorkerLost("lost")


@pytest.mark.parametrize(("failures", "given_up"), [(2, False), (3, True)])
def test_only_losses_in_a_row_without_any_outcome_count(failures: int, *, given_up: bool) -> None:
    kept: dict[int, int] = {}

    def run() -> None:
        items = {n: n for n in range(9)}
        work_off(items, abs, Flaky(failures), kept.__setitem__, name=str, mend="go on")

    if given_up:
        with pytest.raises(RunFailed, match=r"^lost; not done: 0, 1, 2 and 6 more; go on$"):
            run()
    else:
        run()
        assert kept == {n: n for n in range(9)}


def test_one_job_is_this_process_and_by_default_every_usable_cpu_has_one(
    stand_ins: ModuleType, tmp_path: Path
) -> None:
    gc.unfreeze()  # what the suite keeps from being looked through
    try:
        assert list(LocalWorkers(1).map(stand_ins.hang_after_the_first, [(0, tmp_path)])) == [0]
        assert not gc.get_freeze_count(), "garbage of a user's process is still found"
    finally:
        gc.freeze()
    assert int((tmp_path / "0.pid").read_text()) == os.getpid()
    assert LocalWorkers(None).jobs == len(os.sched_getaffinity(0))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_a_signal_to_all_processes_of_a_terminal_ends_them_tidily_in_one_line(
    command: subprocess.Popen[str], tmp_path: Path, number: signal.Signals
) -> None:
    wait_until(lambda: len(list(tmp_path.glob("*.pid"))) == 3)
    os.killpg(command.pid, number)
    _, errors = command.communicate(timeout=PATIENCE)
    assert (command.returncode, errors) == (128 + number, f"stopped by {number.name}\n")
    assert {file.stem for file in tmp_path.glob("*.tidied")} == {"0", "1", "2"}
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
    """Ids of workers that still run; one whose exit code nobody has asked for does not."""
    words = ["ps", "-o", "stat=", "-p"]
    pids = [int(file.read_text() or 0) for file in folder.glob("*.pid")]
    states = {
        pid: subprocess.run([*words, str(pid)], capture_output=True, text=True, check=False).stdout
        for pid in pids
    }
    return [pid for pid, state in states.items() if state and not state.startswith("Z")]


@pytest.mark.parametrize(
    ("words", "mend"),
    [
        ("--backend slurm", "choose one of: local, ray://HOST:PORT, dask:tcp://HOST:PORT"),
        ("--backend local:1", "choose one of: local"),
        ("--address 10.0.0.1:8786", "--address needs --backend ray or --backend dask"),
        ("--jobs 0", "give 1 or more"),
        ("--jobs -1", "give 1 or more"),
        ("--backend ray --address auto --jobs 2", "--jobs is for local processes"),
        ("--backend dask", "needs one address of a cluster"),
        ("--backend dask:h:1 --address h:1", "needs one address of a cluster"),
        ("--backend ray --address h:1", r"needs ray: pip install 'rover-harness\[ray\]'"),
        ("--backend dask:tcp://h:1", r"needs distributed: pip install 'rover-harness\[dask\]'"),
    ],
)
def test_a_choice_that_is_not_valid_is_one_line_that_names_the_mend(
    words: str, mend: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for package in ("ray", "distributed"):
        monkeypatch.setitem(sys.modules, package, None)
    parser = argparse.ArgumentParser()
    add_options(parser)
    options = parser.parse_args(words.split())
    with pytest.raises(UsageError, match=mend) as caught:
        workers_of(options.backend, options.address, options.jobs)
    assert "\n" not in str(caught.value)


class Quiet(Cluster):
    """A cluster of threads, for what both kinds have in common."""

    name, start = "the cluster", "`start`"

    pool: ThreadPoolExecutor

    def submit(self, call: Callable[[], Any]) -> "Future[Any]":
        return self.pool.submit(call)

    def cancel(self) -> None:
        self.pool.shutdown(cancel_futures=True)


@pytest.mark.parametrize("address", ["", "head", "head:", ":1", "a b:1", "head:1/x", "car"])
def test_what_is_no_address_is_refused(address: str) -> None:
    with pytest.raises(UsageError, match=r"is no address of a cluster; start one with .*HOST:PORT"):
        Quiet(address)


def test_a_cluster_is_chosen_by_one_word_or_two(monkeypatch: pytest.MonkeyPatch) -> None:
    connect = {kind: lambda at, kind=kind: (kind, at) for kind in ("ray", "dask")}
    monkeypatch.setattr("harness.base.workers.CLUSTERS", connect)
    words = ("ray://h:1", "ray auto", "ray:h:1", "dask:tcp://h:1", "dask h:1")
    chosen: list[object] = [workers_of(*one.split()[:2]) for one in words]  # type: ignore[arg-type]
    addresses = ["ray://h:1", "auto", "h:1", "tcp://h:1", "h:1"]
    assert chosen == [(one[:4].rstrip(": "), at) for one, at in zip(words, addresses, strict=True)]


# Where something is to be said first, patience is long: Python starts late on a busy machine.
@pytest.mark.parametrize(
    ("patience", "trial", "message"),
    [
        (0.1, "import time; time.sleep(60)", r"does not answer at .* \(nothing within 0\.1 s\); start"),
        (60.0, "raise ValueError('not mine')", r"\(ValueError: not mine\); start one with `start`"),
        (60.0, "pass", r"\(it ended silently\)"),
        (60.0, "print(0)", r"has no worker"),
        (0.0, "", r"Connection refused"),  # nobody listens
    ],
)
def test_what_does_not_answer_as_a_cluster_with_workers_is_one_line(
    patience: float, trial: str, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "PATIENCE", patience)
    monkeypatch.setattr(Quiet, "trial", trial, raising=False)
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"127.0.0.1:{server.getsockname()[1]}"
        if not patience:
            server.close()
        with pytest.raises(UsageError, match=message) as caught:
            Quiet(address)
    assert "\n" not in str(caught.value)


@pytest.fixture
def threads(monkeypatch: pytest.MonkeyPatch) -> Iterator[Quiet]:
    monkeypatch.setattr(Quiet, "trial", "print('hello'); print(3.0)", raising=False)
    with ThreadPoolExecutor(2) as pool:
        monkeypatch.setattr(Quiet, "pool", pool, raising=False)
        yield Quiet("auto")


def meet(barrier: threading.Barrier) -> None:
    barrier.wait(0.2)


def test_a_process_of_a_cluster_does_one_thing_at_a_time() -> None:
    met = threading.Barrier(2)
    with ThreadPoolExecutor(2) as pool:
        calls = [pool.submit(module._work_elsewhere, meet, met, versions()) for _ in range(2)]
        outcomes = [call.result() for call in calls]
    assert all(isinstance(error, threading.BrokenBarrierError) for _, error in outcomes)


def test_a_cluster_gives_every_outcome_once_and_what_is_raised_with_its_traceback(
    threads: Quiet, stand_ins: ModuleType
) -> None:
    assert sorted(threads.map(stand_ins.square, range(4))) == [(n, n * n) for n in range(4)]
    threads.pool = ThreadPoolExecutor(2)  # a map ends with `cancel`
    with pytest.raises(ValueError, match="three") as caught:
        list(threads.map(stand_ins.fail_at_3, range(5)))
    assert "in fail_at_3" in caught.value.__notes__[0]


def test_a_worker_with_another_version_is_refused(
    threads: Quiet, stand_ins: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = iter([{**versions(), "numpy": "2.old"}, versions()])  # by the command, by its worker
    monkeypatch.setattr(module, "versions", lambda: next(asked))
    with pytest.raises(UsageError, match=r"has numpy \S+ instead of 2\.old; .*install the same there"):
        list(threads.map(stand_ins.square, [1]))


def test_a_worker_without_this_package_is_reported(
    threads: Quiet, stand_ins: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    def load_nothing(_: bytes) -> None:
        raise ModuleNotFoundError("No module named 'harness'")

    monkeypatch.setattr("harness.base.workers.clusters.pickle.loads", load_nothing)
    with pytest.raises(UsageError, match=r"No module named 'harness'.*install rover-harness\[tune\]"):
        list(threads.map(stand_ins.square, range(2)))
