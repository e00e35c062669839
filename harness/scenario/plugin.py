"""Scenarios as tests: `pytest --rover scenarios/` collects *.scenario.yaml, a test a run.

Part of every pytest where this package is installed, so it loads nothing before it is asked for. A
scenario with a pass_rate is one test. Artefacts go where --rover-artifacts of harness.testing.plugin
says, if that is in use, else below pytest's temporary folder.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from _pytest._code.code import TerminalRepr

    from harness.scenario.attempt import Attempt
    from harness.scenario.case import Case
    from harness.scenario.verdict import Verdict


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


class ScenarioFailed(Exception):
    """An expectation was not met; its message says which, and how to see it again."""


class ScenarioFile(pytest.File):
    """A scenario's runs."""

    def collect(self) -> "Iterator[ScenarioRun]":
        """Yields a test a run; one for all where a share of them may fail."""
        from harness.errors import UsageError  # noqa: PLC0415 - see above
        from harness.scenario.suite import plan  # noqa: PLC0415

        count = self.config.getoption("rover_seeds")
        shown = self.path
        if shown.is_relative_to(
            self.config.invocation_params.dir
        ):  # short, and it can be repeated there
            shown = shown.relative_to(self.config.invocation_params.dir)
        try:
            cases = plan([shown], None if count is None else range(count))
        except UsageError as error:
            raise self.CollectError(str(error)) from error
        groups = [[case] for case in cases] if cases[0].scenario.pass_rate is None else [cases]
        for group in groups:
            name = group[0].name if len(group) == 1 else group[0].name.partition("[")[0]
            yield ScenarioRun.from_parent(self, name=name, cases=group)


class ScenarioRun(pytest.Item):
    """A test: runs in its set-up, so that what could not run is an error, and judges when called."""

    def __init__(self, *, cases: "list[Case]", **rest: Any) -> None:  # noqa: ANN401 - pytest's own
        super().__init__(**rest)
        self.cases = cases

    def setup(self) -> None:
        """Drives the rover."""
        from harness.errors import RunFailed  # noqa: PLC0415 - see above
        from harness.scenario.attempt import attempt  # noqa: PLC0415
        from harness.scenario.junit import properties_of  # noqa: PLC0415
        from harness.scenario.verdict import verdicts_of  # noqa: PLC0415

        folder = self._folder()
        attempts = [attempt(case, folder / case.folder) for case in self.cases]
        for one in attempts:
            self.user_properties += properties_of(one).items()
        errors = [one.error for one in attempts if one.error is not None]
        if errors:
            raise RunFailed(f"{self.name} could not run: {errors[0]}; again: {attempts[0].case.command}")
        (self._verdict,) = verdicts_of(attempts)

    def runtest(self) -> None:
        """Passes, fails, or fails as expected.

        Raises:
            ScenarioFailed: Something was not as expected.
        """
        from harness.scenario.verdict import Outcome, outcome_of  # noqa: PLC0415 - see above

        verdict: Verdict = self._verdict
        attempts = verdict.attempts
        if verdict.outcome is not Outcome.PASSED:
            raise ScenarioFailed("\n".join(_told(attempt) for attempt in attempts))
        if all(outcome_of(attempt) is Outcome.EXPECTED for attempt in attempts):
            known = attempts[0].case.expected_failure
            pytest.xfail(known.reason if known else "")

    def repr_failure(
        self,
        excinfo: pytest.ExceptionInfo[BaseException],
        style: Any = None,  # noqa: ANN401 - pytest's
    ) -> "str | TerminalRepr":
        """Returns what a person needs: no traceback where a run is at fault."""
        from harness.errors import HarnessError  # noqa: PLC0415 - see above

        if isinstance(excinfo.value, ScenarioFailed | HarnessError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Returns where it stands and its name."""
        return self.path, None, self.name

    def _folder(self) -> Path:
        given = self.config.getoption("--rover-artifacts", default=None)
        factory = self.config._tmp_path_factory  # type: ignore[attr-defined]  # noqa: SLF001 - no fixture here
        return Path(given or factory.getbasetemp() / "rover")


def _told(attempt: "Attempt") -> str:
    from harness.scenario.verdict import Outcome, outcome_of, reasons_of  # noqa: PLC0415 - see above

    if outcome_of(attempt) in (Outcome.PASSED, Outcome.EXPECTED):
        return f"{attempt.case.name}: {outcome_of(attempt).value}"
    lines = [*reasons_of(attempt), f"again: {attempt.case.command}", *map(str, attempt.kept[:1])]
    return "\n".join(lines)
