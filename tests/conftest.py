"""What every test stands on: field checks in ROS messages, local discovery, a domain of its own."""

import itertools
import os
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

# Before any test imports rclpy: a wrongly typed field must raise, not be sent as garbage.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"

# A loaded machine is slow; that is no fault of the code under test.
settings.register_profile("patient", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("patient")

_DOMAINS = 100  # 1..100: above 101 DDS ports fall into the ephemeral range


@pytest.fixture(scope="session")
def ros_domains() -> Iterator[int]:
    """ROS domains, each of which no other test of this run uses at the same time."""
    return (count % _DOMAINS + 1 for count in itertools.count(os.getpid()))


@pytest.fixture
def ros_domain(ros_domains: Iterator[int], monkeypatch: pytest.MonkeyPatch) -> int:
    """Such a domain, in force."""
    domain = next(ros_domains)
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    return domain
