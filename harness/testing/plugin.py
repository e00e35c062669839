"""The pytest fixture; `pytest_plugins = ["harness.testing.plugin"]` in conftest.py makes it known.

A test that fails leaves the recording and the page of its trials, and its report says where.
"""

import re
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from harness.spec.run import Run
from harness.testing.trial import Trial

TRIALS = pytest.StashKey[list[Any]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds --rover-artifacts."""
    parser.getgroup("rover").addoption(
        "--rover-artifacts",
        type=Path,
        metavar="DIR",
        help="keep recordings and pages of failed trials there, not in pytest's temporary folder",
    )


@pytest.fixture
def start_trial(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Callable[[Any], Any]]:
    """Starts a trial, a given one or that of a given Run, which ends with the test; one at a time."""
    folder = request.config.getoption("--rover-artifacts") or tmp_path_factory.getbasetemp() / "rover"
    name = re.sub(r"[^\w.-]+", "_", request.node.nodeid).strip("_")
    trials = request.node.stash.setdefault(TRIALS, [])
    with ExitStack() as at_end:

        def start(given: Any) -> Any:  # noqa: ANN401 - a Run or a trial -> the trial
            number = f"-{len(trials) + 1}" if trials else ""
            trial = Trial(given) if isinstance(given, Run) else given
            trial.artifacts = trial.artifacts or folder.absolute() / f"{name}{number}"
            trials.append(trial)
            return at_end.enter_context(trial)

        yield start


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, Any, None]:
    """Keeps the evidence of the trials of a test that has failed; they have not ended yet."""
    outcome = yield
    report = outcome.get_result()
    if report.when == "call" and report.failed and call.excinfo is not None:
        reason = call.excinfo.exconly()
        kept = [trial.keep_evidence(reason) for trial in item.stash.get(TRIALS, [])]
        report.sections.append(("rover trial", "\n".join(filter(None, kept))))
