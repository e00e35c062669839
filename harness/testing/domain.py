"""A ROS domain for one test alone: no other test on this machine gets it at the same time."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager

from harness.errors import UsageError

LAST_DOMAIN = 101  # above it, DDS ports fall into the range that the system hands out


@contextmanager
def reserved_domain() -> Iterator[int]:
    """Reserves a domain by a name that the kernel frees, whatever becomes of this process.

    Raises:
        UsageError: All are taken.
    """
    for attempt in range(LAST_DOMAIN):
        domain = (os.getpid() + attempt) % LAST_DOMAIN + 1
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as reservation:
            try:
                reservation.bind(f"\0rover_harness_domain_{domain}")
            except OSError:
                continue
            yield domain
            return
    message = f"all ROS domains from 1 to {LAST_DOMAIN} are in use by other trials"
    raise UsageError(message)
