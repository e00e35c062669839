"""The pytest fixture; `pytest_plugins = ["harness.testing.plugin"]` in conftest.py makes it known."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from harness.config import EpisodeConfig
from harness.testing.trial import Trial


@pytest.fixture
def start_trial() -> Iterator[Callable[[EpisodeConfig], Trial]]:
    """Starts a trial that ends with the test; one at a time."""
    with ExitStack() as at_end:
        yield lambda config: at_end.enter_context(Trial(config))
