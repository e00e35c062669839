"""What every test stands on: the same surroundings whoever starts it, and a ROS domain of its own."""

import gc
import shutil
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, settings

from harness.ros.network import reserved_domain
from tests.support.browser import CHROMIUM, FLAGS, WEBGL
from tests.support.ros import Ros
from tests.support.surroundings import receive_signals, settle_environment

if TYPE_CHECKING:
    from playwright.sync_api import Browser

ROS_LOG = settle_environment()  # before any test imports rclpy
receive_signals()

# A loaded machine is slow; that is no fault of the code under test.
settings.register_profile("patient", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("patient")

gc.disable()  # until all is loaded, for nearly all of it stays: a quarter of the time of collection


def pytest_collection_finish() -> None:
    gc.freeze()  # else each full collection, and each fork's end, would go through all that was loaded
    gc.set_threshold(10_000, 10, 10)  # what is left is young, and most of it is freed without
    gc.enable()


def pytest_unconfigure() -> None:
    shutil.rmtree(ROS_LOG, ignore_errors=True)


@pytest.fixture
def ros_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain that nobody else on this machine uses at the same time."""
    with reserved_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        yield domain


@pytest.fixture
def ros(ros_domain: int, request: pytest.FixtureRequest) -> Iterator[Ros]:  # noqa: ARG001 - sets the domain
    """A context, an executor, and nodes on demand."""
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    with ExitStack() as at_end:
        yield Ros(at_end, *getattr(request, "param", ()))


@pytest.fixture(scope="module")
def browser() -> Iterator["Browser"]:
    """A headless Chromium."""
    with _chromium(FLAGS) as browser:
        yield browser


@pytest.fixture(scope="module")
def webgl() -> Iterator["Browser"]:
    """A headless Chromium that draws in three dimensions."""
    with _chromium(WEBGL) as browser:
        yield browser


@contextmanager
def _chromium(flags: list[str]) -> Iterator["Browser"]:
    sync_api = pytest.importorskip(
        "playwright.sync_api", reason="needs playwright: pip install -e '.[dev]'"
    )
    with sync_api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=flags)
        yield browser
        browser.close()
