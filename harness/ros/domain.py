"""A free ROS domain: nobody else on this machine who asks here gets it at the same time."""

import itertools
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager

from harness.errors import UsageError

VARIABLE = "ROS_DOMAIN_ID"
LAST_DOMAIN = 101  # above it, DDS ports fall into the range that the system hands out
# Each reservation tries another one first: what was killed in a domain is seen there for some seconds.
# Processes that start together have neighbouring ids: the factor sets them far apart.
_first_choice = itertools.count(37 * os.getpid())


@contextmanager
def reserved_domain() -> Iterator[int]:
    """Reserves a domain by a name that the kernel frees, whatever becomes of this process.

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
    message = f"all ROS domains from 1 to {LAST_DOMAIN} are reserved by other processes"
    raise UsageError(message)


@contextmanager
def own_domain() -> Iterator[None]:
    """Puts this process and its children into a reserved domain, unless the user has chosen one."""
    if VARIABLE in os.environ:
        yield
        return
    with reserved_domain() as domain:
        os.environ[VARIABLE] = str(domain)
        try:
            yield
        finally:
            del os.environ[VARIABLE]
