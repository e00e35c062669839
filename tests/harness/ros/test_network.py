"""Nothing listens beyond this machine unless the user has asked for it."""

import os
import re
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from harness.ros.network import (
    FORMER_VARIABLE,
    OWN_PROFILE,
    PROFILE,
    PROFILE_VARIABLE,
    RANGE,
    USERS_OWN,
    local_settings,
)
from tests.support.forked_program import ForkedProgram
from tests.support.waiting import wait_until

LOOPBACK = re.compile(r".{6}7F|0{24}01000000")  # 127.x.x.x and ::1, of a little-endian machine
READING = 0.3  # [s]: a listener reads at once
LOCALHOST = {RANGE: "LOCALHOST"}
KILTED = {"ROS_DISTRO": "kilted"}


@pytest.mark.parametrize(
    ("environment", "added"),
    [
        *(
            (own, {**LOCALHOST, PROFILE_VARIABLE: str(PROFILE)})
            for own in (KILTED, KILTED | {RANGE: "localhost"})
        ),
        ({"ROS_DISTRO": "jazzy"}, {**LOCALHOST, FORMER_VARIABLE: str(PROFILE)}),
        *(({RANGE: wider}, {}) for wider in ("SUBNET", "SYSTEM_DEFAULT", "OFF")),
        *(({own: "something"}, LOCALHOST) for own in USERS_OWN),
    ],
)
def test_a_run_stays_on_this_machine_unless_its_user_has_arranged_the_network(
    environment: dict[str, str], added: dict[str, str], tmp_path: Path
) -> None:
    assert local_settings(environment, tmp_path) == added
    (tmp_path / OWN_PROFILE).touch()  # which Fast DDS reads by itself
    assert local_settings(environment, tmp_path) == (LOCALHOST if added else {})


def sockets(process: int) -> dict[tuple[str, str, int], int]:
    """Unread bytes of a process's internet sockets, by kind and address as in /proc/net, and port."""
    links = []
    for descriptor in Path(f"/proc/{process}/fd").iterdir():
        with suppress(OSError):  # closed meanwhile
            links.append(str(descriptor.readlink()))
    own = {link.removeprefix("socket:[").rstrip("]") for link in links}
    found = {}
    for kind in ("udp", "udp6", "tcp", "tcp6"):
        for line in Path(f"/proc/{process}/net/{kind}").read_text().splitlines()[1:]:
            _, bound, _, _, queues, *_, inode = line.split()[:10]
            if inode in own:
                address, port = bound.split(":")
                found[kind, address, int(port, 16)] = int(queues.split(":")[1], 16)
    return found


@contextmanager
def run(log_dir: Path, **settings: str) -> Iterator[int]:
    """A run that drives; gives its process number."""
    words = ["--terrain", "flat", "--duration", "36000", "--rate", "5", "--log-dir", str(log_dir)]
    ours = {PROFILE_VARIABLE, FORMER_VARIABLE, RANGE}
    environment = {name: value for name, value in os.environ.items() if name not in ours} | settings
    with ForkedProgram("harness.run", words, env=environment) as program:
        wait_until(lambda: any(log.read_bytes().count(b"\n") > 1 for log in log_dir.glob("*.csv")))
        yield program.pid


def is_heard(process: int, kind: str, address: str, port: int) -> bool:
    """Whether the process takes what arrives at one of its sockets from outside the machine.

    A socket that only sends is bound, too; what arrives there lies unread.
    """
    if kind.startswith("tcp"):
        return True
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        to = "127.0.0.1" if set(address) == {"0"} else socket.inet_ntoa(bytes.fromhex(address)[::-1])
        stranger.sendto(b"not a message of DDS", (to, port))
    deadline = time.monotonic() + READING
    while time.monotonic() < deadline:
        if not sockets(process).get((kind, address, port)):
            return True
    return False


@pytest.mark.usefixtures("ros_domain")
def test_a_run_hears_nobody_outside_this_machine(tmp_path: Path) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    with run(tmp_path) as process:
        bound = sockets(process)
        assert bound, "a run without sockets?"
        outside = [one for one in bound if not LOOPBACK.fullmatch(one[1])]
        assert [one for one in outside if is_heard(process, *one)] == []
