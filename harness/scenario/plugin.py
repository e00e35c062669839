"""Scenarios as tests: `pytest --rover scenarios/` collects *.scenario.yaml, a test per run.

Part of every pytest where this package is installed, so it loads nothing before it is asked for. A
scenario with a pass_rate is one test. Artefacts go where --rover-artifacts of harness.testing.plugin
says, if that is in use, else below pytest's temporary folder.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from harness.scenario.case import Case
    from harness.scenario.verdict import Attempt


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds --rover and --rover-seeds."""
    group = parser.getgroup("rover")
    group.addoption("--rover", action="store_true", help="collect *.scenario.yaml (docs/scenarios.md)")
    group.addoption(
        "--rover-seeds", type=int, metavar="N", help="run each with seeds 0 to N-1, not with its own"
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "ScenarioFile | None":
    """Takes scenarios, if they are asked for."""
    if parent.config.getoption("rover") and file_path.name.endswith(".scenario.yaml"):
        return ScenarioFile.from_parent(parent, path=file_path)
    return None


class ScenarioFile(pytest.File):
    """A scenario's runs."""

    def collect(self) -> "Iterator[ScenarioRun]":
        """Yields a test per run; one for all where a share of them may fail."""
        from harness.base.errors import UsageError  # noqa: PLC0415 - only if asked for
        from harness.scenario.case import plan  # noqa: PLC0415

        count, here = self.config.getoption("rover_seeds"), self.config.invocation_params.dir
        path = self.path.relative_to(here) if self.path.is_relative_to(here) else self.path
        try:
            cases = plan([path], None if count is None else range(count))
        except UsageError as error:
            raise self.CollectError(str(error)) from error
        if cases[0].scenario.pass_rate is not None:
            yield ScenarioRun.from_parent(self, name=cases[0].name.partition("[")[0], cases=cases)
            return
        for case in cases:
            yield ScenarioRun.from_parent(self, name=case.name, cases=[case])


class ScenarioRun(pytest.Item):
    """A test: runs in its set-up, so that what could not run is an error, and judges when called."""

    def __init__(self, *, cases: "list[Case]", **rest: Any) -> None:  # noqa: ANN401 - pytest's own
        super().__init__(**rest)
        self.cases = cases
        self._attempts: list[Attempt] = []

    def setup(self) -> None:
        """Drives the rover; what cannot be run is an error of the test."""
        from harness.scenario.attempt import attempt  # noqa: PLC0415 - only if asked for
        from harness.scenario.junit import properties_of  # noqa: PLC0415

        folder = self._folder()
        self._attempts = [attempt(case, folder / case.folder) for case in self.cases]
        for one in self._attempts:
            self.user_properties += properties_of(one).items()
            if one.error is not None:
                line = f"{one.case.name} could not run: {one.error}\nagain: {one.case.command}"
                pytest.fail(line, pytrace=False)

    def runtest(self) -> None:
        """Passes, fails, or fails as expected."""
        from harness.scenario.verdict import Outcome, outcome_of, verdicts_of  # noqa: PLC0415 - only if asked for

        (verdict,) = verdicts_of(self._attempts)
        if verdict.outcome is not Outcome.PASSED:
            bad = [one for one in self._attempts if not outcome_of(one).is_good]
            pytest.fail("\n".join(_lines(one) for one in bad), pytrace=False)
        known = self.cases[0].expected_failure
        if known is not None and outcome_of(self._attempts[0]) is Outcome.EXPECTED:
            pytest.xfail(known.reason)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Returns where it stands and its name."""
        return self.path, None, self.name

    def _folder(self) -> Path:
        given = self.config.getoption("--rover-artifacts", default=None)
        if given is not None:
            return Path(given)
        factory = self.config._tmp_path_factory  # type: ignore[attr-defined]  # noqa: SLF001 - no fixture here
        return Path(factory.getbasetemp() / "rover")


def _lines(attempt: "Attempt") -> str:
    from harness.scenario.verdict import reasons_of  # noqa: PLC0415 - only if asked for

    see = [f"see:   {path}" for path in attempt.kept[:1]]
    return "\n".join([*reasons_of(attempt), f"again: {attempt.case.command}", *see])
