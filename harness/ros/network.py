"""Where ROS 2 may talk: on this machine unless the user has asked for more, in a domain of one's own.

ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST alone is not enough: with it Fast DDS announces itself to this
machine only, but its sockets still receive on every network device, and whoever knows their ports can
talk to them. The profile beside this file ties them to the loopback device. Other middlewares ignore it.
"""

import itertools
import os
import socket
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from harness.base.errors import UsageError

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
LOCAL = "LOCALHOST"
PROFILE = Path(__file__).with_name("local_machine.xml")
PROFILE_VARIABLE = "FASTDDS_DEFAULT_PROFILES_FILE"
FORMER_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
FORMER_DISTRIBUTIONS = ("humble", "iron", "jazzy")  # know only that
KILTED = 9  # the first part of its rclpy's version
OWN_PROFILE = "DEFAULT_FASTDDS_PROFILES.xml"  # in the current folder; Fast DDS reads it by itself
# Whoever sets one of these has arranged the network, or the middleware, as it shall be.
USERS_OWN = (PROFILE_VARIABLE, FORMER_VARIABLE, "ROS_STATIC_PEERS", "ROS_DISCOVERY_SERVER")

LAST_DOMAIN = 101  # above it, DDS ports fall into the range that the system hands out
# Each reservation tries another one first: what was killed in a domain is seen there for some seconds.
# Processes that start together have neighbouring ids: the factor sets them far apart.
_first_choice = itertools.count(37 * os.getpid())


def stay_local() -> None:
    """Sets up the environment of this process and its children; call it before rclpy.init."""
    os.environ.update(local_settings(os.environ, Path.cwd()))


def local_settings(environment: Mapping[str, str], folder: Path) -> dict[str, str]:
    """Returns what to add to an environment, for a process in a folder, so that nothing listens beyond.

    What the user has said about the network stays so.
    """
    if environment.get(RANGE, LOCAL).upper() != LOCAL:
        return {}
    settings = {RANGE: LOCAL}
    if any(environment.get(name) for name in USERS_OWN) or (folder / OWN_PROFILE).exists():
        return settings
    return settings | {FORMER_VARIABLE if _is_former(environment) else PROFILE_VARIABLE: str(PROFILE)}


def _is_former(environment: Mapping[str, str]) -> bool:
    """Whether Fast DDS is that of a distribution before Kilted; only a sourced one sets ROS_DISTRO."""
    if distribution := environment.get("ROS_DISTRO"):
        return distribution in FORMER_DISTRIBUTIONS
    try:
        return int(version("rclpy").split(".")[0]) < KILTED
    except PackageNotFoundError:
        return False


@contextmanager
def reserved_domain() -> Iterator[int]:
    """Yields a ROS domain that nobody else who asks here gets at the same time.

    It is reserved by a name that the kernel frees, whatever becomes of this process.

    Raises:
        UsageError: All are taken.
    """
    first = next(_first_choice)
    for attempt in range(LAST_DOMAIN):
        domain = (first + attempt) % LAST_DOMAIN + 1
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as reservation:
            try:
                reservation.bind(f"\0rover_harness_domain_{domain}")
            except OSError:
                continue
            yield domain
            return
    raise UsageError(
        f"all ROS domains from 1 to {LAST_DOMAIN} are reserved by other processes; end some"
    )
