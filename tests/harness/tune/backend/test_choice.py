"""What a user may choose; everything else is one line that names the mend."""

import socket
import sys
from collections.abc import Iterator
from dataclasses import replace

import pytest

from harness.base.errors import UsageError
from harness.tune.backend import address as addresses
from harness.tune.backend import backend_of
from harness.tune.backend.address import ClusterKind


@pytest.mark.parametrize(
    ("name", "address", "jobs", "told"),
    [
        ("slurm", None, None, "unknown backend 'slurm'; choose one of: local, ray, dask"),
        ("local", "10.0.0.1:8786", None, "--address needs --backend ray or --backend dask"),
        ("local", None, 0, "0 jobs are not valid; give 1 or more"),
        ("local", None, -1, "-1 jobs are not valid; give 1 or more"),
        ("ray", "auto", 2, "--jobs is for local processes; --backend ray uses all workers"),
        ("dask", None, None, "--backend dask needs the address of a cluster: --address HOST:PORT"),
    ],
)
def test_a_wrong_choice_is_refused(name: str, address: str | None, jobs: int | None, told: str) -> None:
    with pytest.raises(UsageError, match=f"^{told}"):
        backend_of(name, address, jobs)


@pytest.mark.parametrize(("name", "package"), [("ray", "ray"), ("dask", "distributed")])
def test_a_missing_extra_is_named(name: str, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.delitem(sys.modules, f"harness.tune.backend.{name}_cluster", raising=False)

    with pytest.raises(UsageError, match=rf"needs {package}: pip install 'rover-harness\[{name}\]'$"):
        backend_of(name, "127.0.0.1:1", None)


KIND = ClusterKind(name="Ray cluster", schemes=("tcp",), names=("auto",), trial="", mend="start one")


@pytest.mark.parametrize(
    ("address", "place"),
    [
        ("head:6379", ("head", 6379)),
        ("tcp://10.0.0.1:1", ("10.0.0.1", 1)),
        ("[::1]:65535", ("::1", 65535)),
        ("auto", None),  # a name may stand for an address
    ],
)
def test_addresses(address: str, place: tuple[str, int] | None) -> None:
    assert KIND.place(address) == place


@pytest.mark.parametrize(
    "address",
    ["", "head", "head:", ":1", "head:0", "head:65536", "http://head:1", "a b:1", "head:1/x", "car"],
)
def test_what_is_no_address_is_refused(address: str) -> None:
    told = r"is not valid; give one of: HOST:PORT, tcp://HOST:PORT, auto$"
    with pytest.raises(UsageError, match=told):
        KIND.check(address)


@pytest.fixture
def listener() -> Iterator[str]:
    """The address of something that listens, and says nothing."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield f"127.0.0.1:{server.getsockname()[1]}"


def test_a_closed_port_is_told_at_once() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"127.0.0.1:{server.getsockname()[1]}"

    with pytest.raises(UsageError) as caught:
        replace(KIND, trial="raise SystemExit('not asked')").check(address)

    assert str(caught.value) == f"no Ray cluster answers at {address} (Connection refused); start one"


DENIED = "import sys, time; print('[1 W] denied', file=sys.stderr, flush=True); time.sleep(60)"


# Where something is to be said first, patience is long: Python starts late on a busy machine.
@pytest.mark.parametrize(
    ("patience", "code", "told"),
    [
        (0.1, "import time; time.sleep(60)", r"no Ray cluster .* \(a connection, but no answer"),
        (2.5, DENIED, r"no answer within 2\.5 s: denied\); start one$"),
        (60.0, "raise ValueError('not mine')", r"no Ray .* \(ValueError: not mine\); start"),
        (60.0, "pass", r"no Ray cluster answers at .* \(it left without a word\)"),
        (60.0, "print(0)", r"the Ray cluster at .* has no worker"),
    ],
)
def test_what_does_not_answer_as_a_cluster_is_told(
    listener: str, patience: float, code: str, told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(addresses, "PATIENCE", patience)

    with pytest.raises(UsageError, match=told):
        replace(KIND, trial=code).check(listener)


def test_a_cluster_that_tells_of_workers_is_there(listener: str) -> None:
    replace(KIND, trial="print('hello'); print(3.0)").check(listener)
