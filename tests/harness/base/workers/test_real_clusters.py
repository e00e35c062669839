"""A real Ray and a real Dask cluster of this machine: sweeps and matrices as on local processes.

Run by `make test-cluster`: Ray is too big (200 MB) to be installed for every developer.
"""

import importlib.util
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from types import ModuleType

import pytest

from harness.base.errors import UsageError
from harness.base.workers import WorkerLost, Workers, workers_of
from harness.course.drive import cases_of as episodes_of
from harness.course.drive import drive_all
from harness.course.entry import find_entry
from harness.course.tracks import find_track
from harness.scenario.case import plan as cases_of
from harness.scenario.suite import run_all
from harness.tune.episodes.plan import plan
from harness.tune.episodes.store import Store, encode
from harness.tune.episodes.sweep import sweep
from tests.support.waiting import free_port, wait_until

HERE = Path(__file__).parent
ROOT = HERE.parents[3]
PATIENCE = 60.0  # [s]
PLANNED = plan(("leo", "rover_zero4wd"), 4, 0, 2.0)
MATRIX = """
about: Runs that nobody can pass, so that each leaves its evidence.
terrain: rocky
driver: wander
duration: 2
matrix: {robot: [leo, rover_zero4wd]}
seeds: 4
expect: {truth.resets: {over: end, min: 1}, truth.speed: {max: 5}}
"""
ENTRY = """
from harness.drivers.beeline import Beeline
class Mine(Beeline):
    pass
"""
PACKAGES = {"ray": "ray", "dask": "distributed"}


@pytest.fixture(scope="module", params=PACKAGES)
def kind(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    if importlib.util.find_spec(PACKAGES[name]) is None:
        pytest.skip(f"needs the extra [{name}]; `make test-cluster` installs it")
    return name


@pytest.fixture(scope="module", autouse=True)
def token() -> Iterator[None]:
    """Of the Ray cluster: nobody else may use it, nor does it depend on whether the user has one."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RAY_AUTH_MODE", "token")
        patch.setenv("RAY_AUTH_TOKEN", uuid.uuid4().hex)
        yield


@pytest.fixture(scope="module")
def address(kind: str) -> Iterator[str]:
    """Of a cluster with two workers."""
    clusters = {"ray": ray_cluster, "dask": dask_cluster}
    with clusters[kind]() as address:
        yield address


@pytest.fixture
def workers(kind: str, address: str) -> Iterator[Workers]:
    with workers_of(f"{kind}:{address}") as workers:
        yield workers


def swept(workers: Workers, folder: Path, show: Callable[..., None]) -> object:
    records = sweep(PLANNED, Store(folder, PLANNED), workers, show)
    assert set(records) == set(PLANNED)
    return {one: encode(record) for one, record in records.items()}


def driven(workers: Workers, folder: Path, show: Callable[..., None]) -> object:
    file = folder.parent / "matrix.scenario.yaml"
    file.write_text(MATRIX)
    attempts = run_all(cases_of([file], None, ()), workers, folder, show)
    assert len(attempts) == 8
    assert all(one.breaches for one in attempts)
    return [(one.case, one.breaches, one.measured, one.error) for one in attempts]


def judged(workers: Workers, folder: Path, show: Callable[..., None]) -> object:
    """Episodes of the Course by an entry in files of its own, which travel."""
    files = {"entry.yaml": "driver: mine.py:Mine\nlock: lock.txt\n", "lock.txt": "", "mine.py": ENTRY}
    (own := folder / "mine").mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (own / name).write_text(text)
    entry = find_entry(str(own))
    return drive_all(
        episodes_of([find_track("barn"), find_track("rocky")], entry, 2), entry, workers, show
    )


@pytest.mark.parametrize("work", [swept, driven, judged])
def test_work_with_a_killed_worker_comes_to_what_it_does_on_local_processes(
    work: Callable[..., object], workers: Workers, stand_ins: ModuleType, tmp_path: Path
) -> None:
    pids = sorted(set(workers.map(stand_ins.process_id, range(8))))

    def kill(done: int, *_: int) -> None:
        if done == 1:
            os.kill(pids[0], signal.SIGKILL)

    expected = work(workers_of("local", jobs=2), tmp_path / "local", lambda *_: None)
    assert work(workers, tmp_path / "cluster", kill) == expected


def test_work_that_kills_every_worker_is_reported(workers: Workers, stand_ins: ModuleType) -> None:
    with pytest.raises(WorkerLost, match="out of memory"):
        list(workers.map(stand_ins.die_at_3, range(6)))
    assert len(list(workers.map(stand_ins.square, range(6)))) == 6


def test_a_lost_connection_starts_no_other_ray(address: str, kind: str) -> None:
    if kind != "ray":
        pytest.skip("Dask starts nothing by itself")
    import ray  # noqa: PLC0415 - only where it is installed

    with workers_of("ray", address) as workers:
        list(workers.map(abs, [1]))
        ray.shutdown()

        with pytest.raises(WorkerLost, match="is gone"):
            list(workers.map(abs, [1]))
        assert not ray.is_initialized()


@pytest.mark.parametrize("scheme", ["", "ray://"])
def test_what_is_no_ray_is_refused_within_seconds(scheme: str) -> None:
    pytest.importorskip("ray", reason="needs the extra [ray]")
    with socket.create_server(("127.0.0.1", 0)) as server:
        started = time.monotonic()
        with pytest.raises(UsageError, match="the Ray cluster does not answer at"):
            workers_of(f"ray:{scheme}127.0.0.1:{server.getsockname()[1]}")
    assert time.monotonic() - started < PATIENCE


def test_a_dask_scheduler_without_workers_is_refused() -> None:
    pytest.importorskip("distributed", reason="needs the extra [dask]")
    with dask_scheduler() as address, pytest.raises(UsageError, match="has no worker"):
        workers_of(f"dask:tcp://{address}")


def test_a_dask_scheduler_that_goes_away_is_reported(tmp_path: Path, stand_ins: ModuleType) -> None:
    pytest.importorskip("distributed", reason="needs the extra [dask]")
    with ExitStack() as running:
        address = running.enter_context(dask_cluster())
        with workers_of("dask", address) as workers:
            outcomes = workers.map(stand_ins.hang_after_the_first, [(n, tmp_path) for n in range(4)])
            assert next(outcomes) == 0
            running.close()
            for _ in range(2):  # what was under way, and a new try
                with pytest.raises(WorkerLost, match="the Dask cluster"):
                    list(outcomes)
                outcomes = workers.map(stand_ins.square, range(2))


@contextmanager
def ray_cluster() -> Iterator[str]:
    """A head with two workers; its sockets need a short path."""
    address, ray = f"127.0.0.1:{free_port()}", Path(sys.executable).with_name("ray")
    short = Path(f"/tmp/ray-{os.getpid()}")  # noqa: S108 - see above
    options = ["--num-cpus=2", "--include-dashboard=false", "--disable-usage-stats"]
    ports = [f"--port={address.split(':')[1]}", f"--ray-client-server-port={free_port()}"]
    low_ports = ["--min-worker-port=0", "--max-worker-port=0"]  # any that are free
    with subprocess.Popen(
        [ray, "start", "--head", "--block", f"--temp-dir={short}", *options, *ports, *low_ports],
        env=worker_environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as head:
        try:
            wait_until_it_listens(address)
            yield address
        finally:
            head.terminate()
            head.wait(PATIENCE)
            shutil.rmtree(short, ignore_errors=True)


@contextmanager
def dask_cluster() -> Iterator[str]:
    """A scheduler with two workers."""
    from distributed import Client  # noqa: PLC0415 - only where it is installed

    with dask_scheduler() as address, dask("worker", address, "--nworkers=2", "--nthreads=1"):
        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=PATIENCE)
        yield address


@contextmanager
def dask_scheduler() -> Iterator[str]:
    port = free_port()
    with dask("scheduler", "--host=127.0.0.1", f"--port={port}"):
        wait_until_it_listens(f"127.0.0.1:{port}")
        yield f"127.0.0.1:{port}"


@contextmanager
def dask(*words: str) -> Iterator[None]:
    """A dask command until the context is left."""
    with subprocess.Popen(
        [sys.executable, "-m", "dask", *words, "--no-dashboard"],
        env=worker_environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as process:
        try:
            yield
        finally:
            process.terminate()
            process.wait(PATIENCE)


def worker_environment() -> dict[str, str]:
    """Workers find this package and the stand-ins."""
    return {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'rover_metrics'}:{HERE}"}


def wait_until_it_listens(address: str) -> None:
    host, port = address.split(":")

    def listens() -> bool:
        with suppress(OSError):
            socket.create_connection((host, int(port)), timeout=1.0).close()
            return True
        return False

    wait_until(listens)
