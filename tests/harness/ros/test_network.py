"""Nothing listens beyond this machine unless the user has asked for it."""

import os
import re
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from ipaddress import IPv4Address, IPv6Address, ip_address
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

READING = 0.3  # [s]: a listener reads at once
LOCALHOST = {RANGE: "LOCALHOST"}


@pytest.mark.parametrize(
    ("environment", "added"),
    [
        *((own, {**LOCALHOST, PROFILE_VARIABLE: str(PROFILE)}) for own in ({}, {RANGE: "localhost"})),
        ({"ROS_DISTRO": "kilted"}, {**LOCALHOST, PROFILE_VARIABLE: str(PROFILE)}),
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


@dataclass(frozen=True)
class Socket:
    """A bound socket: its kind as in /proc/net, where it is bound, bytes that nobody has read."""

    kind: str
    address: IPv4Address | IPv6Address
    port: int
    unread: int

    @property
    def local(self) -> bool:
        return self.address.is_loopback


def sockets(process: int) -> Iterator[Socket]:
    """The internet sockets of a process."""
    links = []
    for descriptor in Path(f"/proc/{process}/fd").iterdir():
        try:
            links.append(str(descriptor.readlink()))
        except OSError:  # noqa: PERF203 - closed meanwhile
            continue
    own = {found[1] for link in links if (found := re.fullmatch(r"socket:\[(\d+)\]", link))}
    for kind in ("udp", "udp6", "tcp", "tcp6"):
        for line in Path(f"/proc/{process}/net/{kind}").read_text().splitlines()[1:]:
            _, bound, _, _, queues, *_, inode = line.split()[:10]
            if inode in own:
                address, port = bound.split(":")
                yield Socket(kind, parsed(address), int(port, 16), int(queues.split(":")[1], 16))


def parsed(address: str) -> IPv4Address | IPv6Address:
    """An address as /proc/net has it: in words of four bytes, each in the machine's own order."""
    words = [bytes.fromhex(address[i : i + 8]) for i in range(0, len(address), 8)]
    return ip_address(b"".join(word[:: 1 if sys.byteorder == "big" else -1] for word in words))


@contextmanager
def run(log_dir: Path, **settings: str) -> Iterator[int]:
    """A run that drives; gives its process number."""
    words = ["--terrain", "flat", "--duration", "36000", "--rate", "5", "--log-dir", str(log_dir)]
    ours = {PROFILE_VARIABLE, FORMER_VARIABLE, RANGE}
    environment = {name: value for name, value in os.environ.items() if name not in ours} | settings
    with ForkedProgram("harness.run", words, env=environment) as program:
        wait_until(lambda: any(log.read_bytes().count(b"\n") > 1 for log in log_dir.glob("*.csv")))
        yield program.pid


def is_heard(process: int, listener: Socket) -> bool:
    """Whether the process takes what arrives at one of its sockets from outside the machine.

    A socket that only sends is bound, too; what arrives there lies unread.
    """
    if listener.kind.startswith("tcp"):
        return True
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        to = "127.0.0.1" if listener.address.is_unspecified else str(listener.address)
        stranger.sendto(b"not a message of DDS", (to, listener.port))
    deadline = time.monotonic() + READING
    while time.monotonic() < deadline:
        now = {(one.kind, one.port): one.unread for one in sockets(process)}
        if not now.get((listener.kind, listener.port)):
            return True
    return False


@pytest.mark.usefixtures("ros_domain")
def test_a_run_hears_nobody_outside_this_machine(tmp_path: Path) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    with run(tmp_path) as process:
        bound = list(sockets(process))
        assert bound, "a run without sockets?"
        assert [one for one in bound if not one.local and is_heard(process, one)] == []
