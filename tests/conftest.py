"""What every test stands on: field checks in ROS messages, local discovery, a domain of its own."""

import itertools
import os

import pytest
from hypothesis import HealthCheck, settings

# Before any test imports rclpy: a wrongly typed field must raise, not be sent as garbage.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"

# A loaded machine is slow; that is no fault of the code under test.
settings.register_profile("patient", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("patient")

_DOMAINS = 100  # 1..100: above 101 DDS ports fall into the ephemeral range
_next_domain = itertools.count()


@pytest.fixture
def ros_domain(monkeypatch: pytest.MonkeyPatch) -> int:
    """A ROS domain that no other test of this run uses at the same time."""
    # Processes that run tests side by side have neighbouring ids: each takes a stretch of its own.
    domain = (29 * os.getpid() + next(_next_domain)) % _DOMAINS + 1
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    return domain
