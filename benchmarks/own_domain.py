"""A ROS domain for benchmarks, in which nobody else disturbs what they measure."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

from harness.ros.network import reserved_domain

DOMAIN = "ROS_DOMAIN_ID"


@contextmanager
def own_domain() -> Iterator[None]:
    """Puts this process and its children into a reserved domain, unless the user has chosen one."""
    if DOMAIN in os.environ:
        yield
        return
    with reserved_domain() as domain:
        os.environ[DOMAIN] = str(domain)
        try:
            yield
        finally:
            del os.environ[DOMAIN]
